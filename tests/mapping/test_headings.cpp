// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Headings in the graph, and how a source of them is judged.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/slam/gnss/gnss_constraints.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/gnss/heading_consensus.hpp"
#include "adit/slam/graph/graph_residuals.hpp"
#include "adit/slam/graph/solver.hpp"
#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tests/support/numerical_jacobian.hpp"

namespace adit {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d any_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  Vector6d xi;
  for (double& value : xi) {
    value = part(random);
  }
  return se3_exp(xi);
}

TEST(HeadingResidual, JacobiansAreThoseOfTheResidual) {
  std::mt19937 random(5);
  for (int i = 0; i < 50; ++i) {
    const Isometry3d world = any_pose(random);
    const Isometry3d node = any_pose(random);
    const MeasuredHeading measured{.axis_node = any_pose(random).linear().col(0),
                                   .yaw = 3.0 * any_pose(random).translation().x(),
                                   .information = 400.0};
    const Vector3d axis = world.linear() * node.linear() * measured.axis_node;
    if (axis.head<2>().norm() < 0.3) {
      continue;  // steep, where differences of finite size are no derivative
    }
    const HeadingResidual residual(measured);
    const WhitenedTie<1> tie = residual.linearized(world, node);
    if (std::abs(tie.residual(0)) > 20.0 * 3.1) {
      continue;  // at the seam of the circle
    }
    EXPECT_NEAR(
        std::remainder(tie.residual(0) / 20.0 - (std::atan2(axis.y(), axis.x()) - measured.yaw),
                       2.0 * std::numbers::pi),
        0.0, 1e-12);
    // A turn about the world's vertical, of the map and of the node.
    const Vector3d up_map = world.linear().transpose() * Vector3d::UnitZ();
    const Vector3d up_node = node.linear().transpose() * up_map;
    const auto turned = [](const Isometry3d& pose, const Vector3d& up, double angle) {
      Vector6d xi = Vector6d::Zero();
      xi.tail<3>() = angle * up;
      return retract(pose, xi);
    };
    const auto by_world = test::numerical_jacobian<1, 1>([&](const auto& angle) {
      return residual.linearized(turned(world, up_map, angle(0)), node).residual;
    });
    const auto by_node = test::numerical_jacobian<1, 1>([&](const auto& angle) {
      return residual.linearized(world, turned(node, up_node, angle(0))).residual;
    });
    EXPECT_NEAR((tie.by_world.rightCols<3>() * up_map)(0), by_world(0), 1e-8) << i;
    EXPECT_NEAR((tie.by_node.rightCols<3>() * up_node)(0), by_node(0), 1e-8) << i;
    EXPECT_TRUE(tie.by_world.leftCols<3>().isZero(0.0) && tie.by_node.leftCols<3>().isZero(0.0));
    EXPECT_LT((tie.by_world.rightCols<3>() - 20.0 * up_map.transpose()).norm(), 1e-9) << "no tilt";
  }
}

// Where the axis is level that is all there is.
TEST(HeadingResidual, OfALevelAxisJacobiansAreTheNumericalOnes) {
  const Isometry3d world(Eigen::AngleAxisd(0.7, Vector3d::UnitZ()));
  const Isometry3d node(Eigen::AngleAxisd(-1.9, Vector3d::UnitZ()));
  const HeadingResidual residual({.axis_node = {0.6, 0.8, 0.0}, .yaw = 0.1, .information = 400.0});
  const WhitenedTie<1> tie = residual.linearized(world, node);
  const auto by_world = test::numerical_jacobian<1, 6>(
      [&](const Vector6d& xi) { return residual.linearized(retract(world, xi), node).residual; });
  const auto by_node = test::numerical_jacobian<1, 6>(
      [&](const Vector6d& xi) { return residual.linearized(world, retract(node, xi)).residual; });
  EXPECT_LT((tie.by_world - by_world).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((tie.by_node - by_node).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(HeadingResidual, AnAxisThatStandsUprightHasNone) {
  const HeadingResidual residual({.axis_node = Vector3d::UnitZ(), .yaw = 1.0, .information = 1.0});
  const WhitenedTie<1> tie = residual.linearized(Isometry3d::Identity(), Isometry3d::Identity());
  EXPECT_EQ(tie.residual(0), 0.0);
  EXPECT_TRUE(tie.by_world.isZero(0.0) && tie.by_node.isZero(0.0));
}

TEST(HeadingResidual, TheGraphTurnsTheMapByIt) {
  PoseGraph graph;
  graph.add_node({.id = 0});
  graph.add_node({.id = 1, .T_map_node = test::step(10.0, 0.0)});
  graph.add_edge(test::edge(0, 1, test::step(10.0, 0.0), 1e4));
  for (const NodeId id : {0, 1}) {
    graph.add_level({.node = id, .information = 2500.0});
  }
  graph.add_fix({.node = 0});
  graph.add_heading({.node = 1, .yaw = 3.0, .information = 1e4});
  const OptimizedGraph optimum = optimize(graph, {});
  const Vector3d axis = optimum.T_world_map.linear().col(0);
  EXPECT_NEAR(std::atan2(axis.y(), axis.x()), 3.0, 1e-4);
  EXPECT_LT(optimum.report.cost_after, 1e-3);
  EXPECT_GT(optimum.report.cost_before, 1e4);
  EXPECT_THROW(graph.add_heading({.node = 7}), GraphError);
  EXPECT_THROW(graph.add_heading({.node = 1, .axis_node = {2.0, 0.0, 0.0}}), GraphError);
  EXPECT_THROW(graph.add_heading({.node = 1, .information = -1.0}), GraphError);
  graph.clear_fixes();
  EXPECT_TRUE(graph.headings().empty());
}

TEST(YawConsensus, MostAgreeAcrossTheSeamOfTheCircle) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::vector<YawSample> samples;
  for (int i = 0; i < 90; ++i) {
    const double turned = i % 3 == 0 ? std::numbers::pi / 2.0 : 0.0;
    samples.push_back(
        {.yaw = wrapped_angle(std::numbers::pi - 0.005 + turned + noise(random)), .sigma = 0.02});
  }
  const auto found = yaw_consensus(samples);
  ASSERT_TRUE(found);
  EXPECT_NEAR(wrapped_angle(found->yaw - std::numbers::pi + 0.005), 0.0, 0.01);
  EXPECT_NEAR(static_cast<double>(found->agreeing), 60.0, 3.0);
  EXPECT_FALSE(yaw_consensus(std::span(samples).first(kFewestHeadings - 1)));
}

constexpr double kMapYawInWorld = 1.2;  // rad, from east to the map's x axis
const Geodetic kPlace{41.65, -0.88, 200.0};

/// A bent way of nodes a metre apart with a fix and two headings a node, as a receiver with two
/// antennas has them: their errors last a minute.
class HeadingDrive {
 public:
  explicit HeadingDrive(NodeId nodes, double fix_sigma = 1.5, unsigned seed = 1)
      : frame_(kPlace), fix_sigma_(fix_sigma) {
    std::mt19937 random(seed);
    std::normal_distribution<double> unit;
    T_world_map_.linear() = Eigen::AngleAxisd(kMapYawInWorld, Vector3d::UnitZ()).matrix();
    T_world_map_.translation() = Vector3d(5.0, -3.0, 1.0);
    const Isometry3d moved = test::step(1.0, 0.02);
    Vector3d drift(unit(random), unit(random), unit(random));
    double turned = unit(random);
    Isometry3d at = Isometry3d::Identity();
    for (NodeId id = 0; id < nodes; ++id, at = at * moved) {
      truth_.push_back(at);
      drift = 0.98 * drift + 0.2 * Vector3d(unit(random), unit(random), unit(random));
      turned = 0.98 * turned + 0.2 * unit(random);
      add_fix(id, fix_sigma * Vector3d(drift.x(), drift.y(), 2.0 * drift.z()));
      for (const double later : {0.0, 0.5}) {
        const Vector3d axis = T_world_map_.linear() * at.linear().col(0);
        headings.push_back({.keyframe = id,
                            .stamp = nanoseconds(static_cast<double>(id) + later),
                            .yaw = std::atan2(axis.y(), axis.x()) +
                                   1.0 * kDegree * (0.95 * turned + 0.3 * unit(random)),
                            .sigma = 1.0 * kDegree});
      }
    }
  }

  GnssConstraints run(const GnssConfig& config = {}) {
    GnssConstraints ties(config);
    graph_ = PoseGraph();
    placed_at_.reset();
    georeference_.reset();
    go_on(ties, 0, static_cast<NodeId>(truth_.size()));
    return ties;
  }

  /// A session of these nodes, behind those that the graph has.
  void go_on(GnssConstraints& ties, NodeId begin, NodeId end) {
    const auto keep = [&](const GnssConstraints::Change& change, NodeId id) {
      placed_at_ = !placed_at_ && change.georeference ? std::optional(id) : placed_at_;
      georeference_ = change.georeference ? change.georeference : georeference_;
      stored_ = change.headings.value_or(stored_);
    };
    for (NodeId id = begin; id < end; ++id) {
      graph_.add_node({.id = id, .T_map_node = truth_[static_cast<std::size_t>(id)]});
      if (id >= levelled_from) {
        graph_.add_level({.node = id, .information = 2500.0});
      }
      if (id > 0) {
        graph_.add_edge(test::edge(id - 1, id, test::step(1.0, 0.02), 1e4));
        graph_.set_pose(id, graph_.nodes()[static_cast<std::size_t>(id) - 1].T_map_node *
                                test::step(1.0, 0.02));
      }
      ties.add(of_node(fixes, id));
      ties.add(of_node(headings, id));
      keep(ties.take_effect(graph_, id), id);
    }
    keep(ties.finish(graph_), end);
  }

  /// rad, of the map against the truth; none: it has no place.
  double yaw_error() const {
    const Vector3d x = graph_.T_world_map().linear().col(0);
    return wrapped_angle(std::atan2(x.y(), x.x()) - kMapYawInWorld);
  }
  double world_error() const {
    double sum = 0.0;
    const WorldFrame found(georeference_->origin);
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      sum += (graph_.T_world_map() * graph_.nodes()[i].T_map_node.translation() -
              found.position_of(frame_.place_of(T_world_map_ * truth_[i].translation())))
                 .head<2>()
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(truth_.size()));
  }
  const std::optional<NodeId>& placed_at() const { return placed_at_; }
  const std::vector<MapHeading>& stored() const { return stored_; }
  const std::optional<Georeference>& georeference() const { return georeference_; }
  const PoseGraph& graph() const { return graph_; }

  std::vector<MapFix> fixes;
  std::vector<MapHeading> headings;
  NodeId levelled_from = 0;  ///< the node from which gravity is known

 private:
  template <class Measured>
  static std::vector<Measured> of_node(const std::vector<Measured>& all, NodeId id) {
    std::vector<Measured> own;
    std::ranges::copy_if(all, std::back_inserter(own),
                         [&](const Measured& one) { return one.keyframe == id; });
    return own;
  }

  void add_fix(NodeId node, const Vector3d& error) {
    GnssFix fix;
    fix.kind = fix_sigma_ < 0.1 ? GnssFixKind::ground_augmented : GnssFixKind::single;
    fix.covariance = fix_sigma_ * fix_sigma_ * Vector3d(1.0, 1.0, 4.0).asDiagonal().toDenseMatrix();
    fixes.push_back({.id = node + 1,
                     .keyframe = node,
                     .stamp = nanoseconds(static_cast<double>(node)),
                     .kind = fix.kind,
                     .place = frame_.place_of(T_world_map_ * truth_.back().translation() + error),
                     .covariance = fix_covariance(fix, {}),
                     .path = static_cast<double>(node)});
  }

  WorldFrame frame_;
  double fix_sigma_;
  Isometry3d T_world_map_ = Isometry3d::Identity();
  std::vector<Isometry3d> truth_;
  PoseGraph graph_;
  std::optional<Georeference> georeference_;
  std::optional<NodeId> placed_at_;
  std::vector<MapHeading> stored_;
};

TEST(Headings, PlaceTheMapAtOnceByASingleFix) {
  HeadingDrive drive(40);
  drive.fixes.resize(1);
  const GnssConstraints ties = drive.run();
  ASSERT_TRUE(drive.placed_at());
  EXPECT_LE(*drive.placed_at(), 5);
  EXPECT_TRUE(ties.report().heading.placed);
  EXPECT_EQ(ties.report().heading.state, HeadingState::used);
  EXPECT_LT(std::abs(drive.yaw_error()), 3.0 * kDegree);
  EXPECT_NEAR(ties.report().georeference->covariance(5, 5), std::pow(1.25 * kDegree, 2),
              std::pow(0.5 * kDegree, 2))
      << "as one heading that is right to 1 degree";
  drive.headings.clear();
  EXPECT_FALSE(drive.run().report().georeference) << "without them one fix places no map";
}

// A single fix and headings placed it, wrongly: nothing contradicted them then.
TEST(Headings, AContinuedMapIsPlacedByItsFixesOnceTheyAreEnough) {
  HeadingDrive drive(200, 0.02);
  std::erase_if(drive.fixes,
                [](const MapFix& fix) { return fix.keyframe > 0 && fix.keyframe < 40; });
  std::erase_if(drive.headings, [](const MapHeading& heading) { return heading.keyframe >= 40; });
  for (MapHeading& heading : drive.headings) {
    heading.yaw += 20.0 * kDegree;
  }
  GnssConstraints first({});
  drive.go_on(first, 0, 40);
  ASSERT_TRUE(drive.georeference());
  EXPECT_GT(std::abs(drive.yaw_error()), 15.0 * kDegree);
  EXPECT_FALSE(drive.stored().empty());

  MapFix used = drive.fixes.front();
  used.verdict = FixVerdict::used;
  used.information = used.covariance.inverse();
  GnssConstraints second({});
  second.begin_behind({used}, drive.stored(), drive.georeference());
  drive.go_on(second, 40, 200);
  EXPECT_LT(std::abs(drive.yaw_error()), 1.0 * kDegree);
  EXPECT_TRUE(drive.stored().empty());
}

// A sensor that has not turned yet has no level, and its axis rises by some milliradians: a roll of
// the map would explain the headings' noise.
TEST(Headings, DoNotTiltAMapThatNothingLevelsYet) {
  HeadingDrive drive(40);
  drive.fixes.resize(1);
  drive.levelled_from = 30;
  for (std::size_t i = 0; i < drive.headings.size(); ++i) {
    drive.headings[i].axis_keyframe =
        Vector3d(1.0, 0.0, 0.004 * std::sin(static_cast<double>(i))).normalized();
  }
  drive.run();
  ASSERT_TRUE(drive.placed_at());
  EXPECT_LT(std::abs(drive.yaw_error()), 3.0 * kDegree);
  EXPECT_GT(drive.graph().T_world_map().linear()(2, 2), 0.999);
}

TEST(Headings, CountAsOneAndKnowTheYawBetterThanShortWaysOfFixes) {
  double with = 0.0;
  double without = 0.0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    HeadingDrive drive(80, 1.5, seed);
    drive.run();
    ASSERT_TRUE(drive.placed_at()) << seed;
    with += std::pow(drive.yaw_error(), 2);
    drive.headings.clear();
    drive.run();
    without += drive.placed_at() ? std::pow(drive.yaw_error(), 2) : std::pow(5.0 * kDegree, 2);
  }
  EXPECT_LT(with, without);
}

struct WrongSource {
  std::string name;
  std::function<void(MapHeading&, std::size_t, const MapHeading& first)> by;
};

TEST(Headings, AWrongSourceIsRefusedAndLeavesTheMapAsWithoutIt) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, 20.0 * kDegree);
  const std::vector<WrongSource> sources{
      {"90 degrees", [](MapHeading& one, auto, auto&) { one.yaw += 90.0 * kDegree; }},
      {"180 degrees", [](MapHeading& one, auto, auto&) { one.yaw += 180.0 * kDegree; }},
      {"5 degrees", [](MapHeading& one, auto, auto&) { one.yaw += 5.0 * kDegree; }},
      {"noisy", [&](MapHeading& one, auto, auto&) { one.yaw += noise(random); }},
      {"stuck", [](MapHeading& one, auto, auto& first) { one.yaw = first.yaw; }}};
  // RTK fixes give the yaw after some metres, single ones after a hundred.
  for (const auto& [sigma, nodes] : {std::pair(0.02, NodeId{40}), std::pair(1.5, NodeId{300})}) {
    HeadingDrive right(nodes, sigma, 4);
    HeadingDrive without = right;
    without.headings.clear();
    without.run();
    for (const WrongSource& source : sources) {
      HeadingDrive drive = right;
      const MapHeading first = drive.headings.front();
      for (std::size_t i = 0; i < drive.headings.size(); ++i) {
        source.by(drive.headings[i], i, first);
      }
      const GnssConstraints ties = drive.run();
      const HeadingReport& report = ties.report().heading;
      ASSERT_TRUE(ties.report().georeference) << source.name;
      EXPECT_LT(drive.world_error(), 1.1 * without.world_error() + 1e-3) << source.name << sigma;
      EXPECT_NE(report.state, HeadingState::used) << source.name << sigma;
      EXPECT_TRUE(drive.graph().headings().empty()) << source.name << sigma;
      EXPECT_TRUE(drive.stored().empty()) << source.name << sigma;
    }
  }
}

TEST(Headings, OutliersAmongThemAreFound) {
  HeadingDrive drive(50, 0.02);
  for (std::size_t i = 0; i < drive.headings.size(); i += 10) {
    drive.headings[i].yaw += 2.0;
  }
  const GnssConstraints ties = drive.run();
  EXPECT_EQ(ties.report().heading.state, HeadingState::used);
  EXPECT_GE(ties.report().heading.verdicts[static_cast<std::size_t>(HeadingVerdict::outlier)], 9U);
  EXPECT_LE(ties.report().heading.verdicts[static_cast<std::size_t>(HeadingVerdict::outlier)], 14U);
  EXPECT_EQ(drive.stored().size(),
            ties.report().heading.verdicts[static_cast<std::size_t>(HeadingVerdict::used)]);
}

TEST(Headings, ASteepAxisHasNoneAndTheErrorCountsAsNoLessThanAntennasReach) {
  HeadingDrive drive(60, 0.02);
  for (MapHeading& heading : drive.headings) {
    heading.axis_keyframe = Vector3d(0.2, 0.0, 1.0).normalized();
  }
  const GnssConstraints ties = drive.run();
  EXPECT_EQ(ties.report().heading.verdicts[static_cast<std::size_t>(HeadingVerdict::impossible)],
            120U);
  EXPECT_EQ(ties.report().heading.state, HeadingState::waiting);
  EXPECT_DOUBLE_EQ(heading_deviation({.sigma = 1e-5}, {}), 0.2 * kDegree);
  EXPECT_DOUBLE_EQ(heading_deviation({}, {}), GnssConfig{}.heading_sigma);
}

// 6 km east of the origin the world's y axis is 0.05 degrees from true north at this latitude.
TEST(Headings, MeridiansComeTogetherAwayFromTheOrigin) {
  const WorldFrame frame(kPlace);
  PoseGraph graph;
  graph.add_node({.id = 0, .T_map_node = test::step(6000.0, 0.0)});
  const MapHeading north{.keyframe = 0, .yaw = std::numbers::pi / 2.0, .information = 1.0};
  const MeasuredHeading measured = as_measured(north, graph, frame);
  const Vector3d here(6000.0, 0.0, 0.0);
  Geodetic farther = frame.place_of(here);
  farther.latitude += 0.001;
  const Vector3d to_north = frame.position_of(farther) - here;
  EXPECT_NEAR(measured.yaw, std::atan2(to_north.y(), to_north.x()), 1e-6);
  EXPECT_GT(std::abs(measured.yaw - north.yaw), 0.04 * kDegree);
}

}  // namespace
}  // namespace adit
