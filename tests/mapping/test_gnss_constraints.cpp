// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/gnss_constraints.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

constexpr double kWorldYaw = 1.2;  // rad, from east to the map's x axis
const Geodetic kOrigin{41.65, -0.88, 200.0};

/// A bent way of nodes a metre apart, whose map climbs and turns as drift does, with two fixes a
/// node from a receiver on a mast.
class Survey {
 public:
  explicit Survey(NodeId nodes, double sigma = 0.02, unsigned seed = 1, double climb = 0.002)
      : frame_(kOrigin), random_(seed) {
    T_world_map_.linear() =
        Eigen::AngleAxisd(kWorldYaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    T_world_map_.translation() = Eigen::Vector3d(5.0, -3.0, 1.0);
    Eigen::Isometry3d moved = test::step(1.0, 0.02);
    Eigen::Isometry3d measured = moved;
    measured.translation().z() += climb;
    Eigen::Isometry3d drifted = Eigen::Isometry3d::Identity();
    truth_ = {Eigen::Isometry3d::Identity()};
    for (NodeId id = 0; id < nodes; ++id) {
      graph_.add_node({.id = id, .T_map_node = drifted});
      graph_.add_level({.node = id, .information = 2500.0});
      if (id > 0) {
        graph_.add_edge(test::edge(id - 1, id, measured, 1e4));
      }
      add_fix(id, 0.0, sigma);
      add_fix(id, 0.5, sigma);
      drifted = drifted * measured;
      truth_.push_back(truth_.back() * moved);
    }
  }

  /// Changes fixes before they are taken.
  void change(const std::function<void(MapFix&)>& by) { std::ranges::for_each(fixes_, by); }

  /// The graph is optimised up to the node `outgrown`.
  GnssConstraints run(const GnssConfig& config = {}, NodeId outgrown = 1'000'000) {
    GnssConstraints ties(config);
    PoseGraph growing;
    for (const PoseNode& node : graph_.nodes()) {
      growing.add_node(node);
      growing.add_level({.node = node.id, .information = 2500.0});
      if (node.id > 0) {
        const PoseEdge& edge = graph_.edges()[static_cast<std::size_t>(node.id) - 1];
        growing.add_edge(edge);
        growing.set_pose(node.id, growing.nodes()[static_cast<std::size_t>(edge.from)].T_map_node *
                                      edge.T_from_to);
      }
      std::vector<MapFix> of_node;
      std::ranges::copy_if(fixes_, std::back_inserter(of_node),
                           [&](const MapFix& fix) { return fix.keyframe == node.id; });
      ties.add(of_node);
      keep(ties.take_effect(growing, node.id, node.id < outgrown));
    }
    keep(ties.finish(growing, graph_.nodes().back().id < outgrown));
    graph_ = growing;
    return ties;
  }

  /// Root mean square of how far nodes lie from where they are in the world, m.
  double world_error() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < graph_.nodes().size(); ++i) {
      sum += (graph_.T_world_map() * graph_.nodes()[i].T_map_node.translation() -
              frame().position_of(frame_.place_of(T_world_map_ * truth_[i].translation())))
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(graph_.nodes().size()));
  }

  std::size_t count(FixVerdict verdict) const {
    return static_cast<std::size_t>(std::ranges::count(fixes_, verdict, &MapFix::verdict));
  }
  const std::vector<MapFix>& fixes() const { return fixes_; }
  std::mt19937& random() { return random_; }

 private:
  void add_fix(NodeId node, double later, double sigma) {
    std::normal_distribution<double> noise(0.0, sigma);
    const Eigen::Vector3d mast(0.2 + later, 0.1, 1.5);
    const Eigen::Vector3d error(noise(random_), noise(random_), 2.0 * noise(random_));
    const Geodetic place = frame_.place_of(T_world_map_ * (truth_.back() * mast) + error);
    GnssFix fix;
    fix.kind = GnssFixKind::ground_augmented;
    fix.covariance = sigma * sigma * Eigen::Vector3d(1.0, 1.0, 4.0).asDiagonal().toDenseMatrix();
    fixes_.push_back({.id = static_cast<int64_t>(fixes_.size()) + 1,
                      .keyframe = node,
                      .stamp = nanoseconds(static_cast<double>(node) + later),
                      .kind = fix.kind,
                      .place = place,
                      .covariance = fix_covariance(fix, {}),
                      .p_keyframe_antenna = mast,
                      .path = static_cast<double>(node) + later});
  }

  void keep(const GnssConstraints::Change& change) {
    for (const MapFix& fix : change.fixes) {
      fixes_[static_cast<std::size_t>(fix.id) - 1] = fix;
    }
    georeference_ = change.georeference ? change.georeference : georeference_;
  }

  WorldFrame frame() const { return WorldFrame(georeference_->origin); }

  WorldFrame frame_;
  std::mt19937 random_;
  Eigen::Isometry3d T_world_map_ = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> truth_;
  PoseGraph graph_;
  std::vector<MapFix> fixes_;
  std::optional<Georeference> georeference_;
};

TEST(GnssConstraints, AGraphThatIsOptimizedNoMoreKeepsItsPlace) {
  Survey survey(80);
  const GnssConstraints ties = survey.run({}, 50);
  ASSERT_TRUE(ties.report().georeference);
  EXPECT_EQ(survey.count(FixVerdict::waiting), 0U);
  EXPECT_LT(survey.world_error(), 0.5);
  Survey whole(80);
  EXPECT_GT(whole.run().report().optimizations, ties.report().optimizations);
  EXPECT_LT(whole.world_error(), survey.world_error());
}

TEST(GnssConstraints, PlacesTheMapAndTakesItsDriftOut) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Survey survey(150, 0.02, seed);
    const GnssConstraints ties = survey.run({.correlation = 1.0});
    ASSERT_TRUE(ties.report().georeference);
    EXPECT_LT(survey.world_error(), 0.03);  // the climb alone is 0.3 m at the end
    EXPECT_GT(survey.count(FixVerdict::used), 250U);
    EXPECT_EQ(survey.count(FixVerdict::outlier) + survey.count(FixVerdict::used) +
                  survey.count(FixVerdict::thinned),
              300U);
    EXPECT_LT(ties.report().horizontal, 0.05);
    EXPECT_GT(ties.report().optimizations, 1U);
  }
}

TEST(GnssConstraints, OutliersDoNotCount) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Survey survey(150, 0.02, seed);
    std::uniform_real_distribution<double> far(10.0, 50.0);
    std::vector<int64_t> wrong;
    survey.change([&](MapFix& fix) {
      if (fix.id % 5 == 0) {
        fix.place.latitude += far(survey.random()) / 111000.0;
        wrong.push_back(fix.id);
      }
    });
    static_cast<void>(survey.run({.correlation = 1.0}));
    EXPECT_LT(survey.world_error(), 0.03);
    for (const int64_t id : wrong) {
      EXPECT_NE(survey.fixes()[static_cast<std::size_t>(id) - 1].verdict, FixVerdict::used);
    }
    EXPECT_GT(survey.count(FixVerdict::used), 200U);
  }
}

TEST(GnssConstraints, AReceiverThatJumpsHalfWayIsNotFollowed) {
  Survey survey(150, 0.02, 3);
  survey.change(
      [](MapFix& fix) { fix.place.latitude += fix.keyframe > 90 ? 5.0 / 111000.0 : 0.0; });
  static_cast<void>(survey.run({.correlation = 1.0}));
  for (const MapFix& fix : survey.fixes()) {
    EXPECT_TRUE(fix.verdict != FixVerdict::used || fix.keyframe <= 90) << fix.id;
  }
  EXPECT_GT(survey.count(FixVerdict::outlier), 100U);
  EXPECT_LT(survey.world_error(), 0.2);
}

TEST(GnssConstraints, AJumpIsReportedWithItsTimeItsSizeAndWhatIsOnEitherSide) {
  for (const NodeId last : {74, 40, 110}) {
    Survey survey(150, 0.02, 3);
    survey.change(
        [&](MapFix& fix) { fix.place.latitude += fix.keyframe > last ? 50.0 / 111000.0 : 0.0; });
    const GnssConstraints ties = survey.run({.correlation = 1.0});
    ASSERT_TRUE(ties.report().jump) << last;
    const ReceiverJump& jump = *ties.report().jump;
    EXPECT_NEAR(jump.distance, 50.0, 1.0) << last;
    EXPECT_EQ(jump.before + jump.after, ties.report().asked);
    const auto at = std::ranges::find(survey.fixes(), last + 1, &MapFix::keyframe);
    EXPECT_NEAR(jump.time, seconds(at->stamp - survey.fixes().front().stamp), 1.0) << last;
  }
}

TEST(GnssConstraints, NoJumpIsReportedWhereThereIsNone) {
  Survey healthy(150, 0.02, 3);
  EXPECT_FALSE(healthy.run({.correlation = 1.0}).report().jump);
  Survey scattered(150, 0.02, 4);
  scattered.change(
      [](MapFix& fix) { fix.place.latitude += fix.id % 3 == 0 ? 50.0 / 111000.0 : 0.0; });
  EXPECT_FALSE(scattered.run({.correlation = 1.0}).report().jump) << "many paths, no jump";
}

TEST(GnssConstraints, FixesWithoutAnAltitudeCountWithTheirLevelPosition) {
  Survey survey(100, 0.02, 4, 0.0);
  survey.change([](MapFix& fix) {
    if (fix.id % 2 == 0) {
      fix.place.altitude = 0.0;
      fix.covariance.row(2).setZero();
      fix.covariance.col(2).setZero();
      fix.covariance(2, 2) = kUnknownHeight * kUnknownHeight;
    }
  });
  const GnssConstraints ties = survey.run({.correlation = 1.0});
  ASSERT_TRUE(ties.report().georeference);
  EXPECT_EQ(survey.count(FixVerdict::outlier), 0U);
  EXPECT_LT(ties.report().vertical, 0.1);
  EXPECT_GT(ties.report().heights, 20U);
  EXPECT_LT(ties.report().heights, survey.count(FixVerdict::used));
  EXPECT_LT(survey.world_error(), 0.2);
}

TEST(GnssConstraints, WithoutHeightsOnlyTheLevelPositionCounts) {
  Survey survey(100, 0.02, 4, 0.0);
  survey.change([](MapFix& fix) { fix.place.altitude += fix.id % 2 == 0 ? 300.0 : -300.0; });
  const GnssConstraints ties = survey.run({.height = false, .correlation = 1.0});
  ASSERT_TRUE(ties.report().georeference);
  EXPECT_EQ(survey.count(FixVerdict::outlier), 0U);
  EXPECT_LT(ties.report().horizontal, 0.05);
}

TEST(GnssConstraints, SaysWhatTheFixesDoNotTell) {
  Survey short_way(4, 1.5, 5);
  const GnssConstraints little = short_way.run();
  EXPECT_FALSE(little.report().georeference);
  EXPECT_GT(short_way.count(FixVerdict::waiting), 0U);

  Survey swapped(150, 0.02, 6);
  swapped.change([](MapFix& fix) { std::swap(fix.place.latitude, fix.place.longitude); });
  const GnssConstraints exchanged = swapped.run({.correlation = 1.0});
  EXPECT_FALSE(exchanged.report().georeference);
  EXPECT_TRUE(exchanged.report().swapped);

  Survey nowhere(50, 0.02, 7);
  nowhere.change([](MapFix& fix) {
    fix.place = fix.id % 2 == 0 ? Geodetic{0.0, 0.0, 0.0}
                                : Geodetic{.latitude = std::nan(""), .longitude = 3.0};
  });
  const GnssConstraints none = nowhere.run();
  EXPECT_FALSE(none.report().georeference);
  EXPECT_EQ(nowhere.count(FixVerdict::impossible), 100U);

  Survey frozen(150, 0.02, 8);
  const Geodetic stuck = frozen.fixes()[200].place;
  frozen.change([&](MapFix& fix) { fix.place = fix.id > 200 ? stuck : fix.place; });
  static_cast<void>(frozen.run({.correlation = 1.0}));
  EXPECT_GT(frozen.count(FixVerdict::frozen), 90U);
  EXPECT_LT(frozen.world_error(), 0.15);  // 0.1 m of climb since the last that moved
}

}  // namespace
}  // namespace adit
