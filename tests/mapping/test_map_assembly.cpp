// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Keyframes of a street driven up and back again, put together with edges that are wrong, or not
// there: what the loops make of that.
#include "adit/slam/mapping/map_assembly.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "adit/slam/executor/slam.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

constexpr std::size_t kWayOut = 50;  // sweeps

/// What the edges tilt by, rad a metre, and whether gravity tells of the first keyframes which way
/// is up.
struct Tilting {
  double pitch = 0.0;
  bool levelled = false;
  std::size_t keyframes = std::numeric_limits<std::size_t>::max();
};

class MapAssemblyTest : public test::DeviceTest {
 protected:
  struct Recorded {
    MapKeyframe keyframe;
    KeyframeSubmap submap;
    Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();  ///< T_first_keyframe
    std::optional<PoseEdge> edge{};
  };

  /// 25 m along the street and backwards again, 0.5 m a sweep, as a run without loops stores it.
  static const std::vector<Recorded>& street() {
    static const std::vector<Recorded> recorded = [] {
      test::SubmapDrive drive{.truth = test::steady_drive(2 * kWayOut, test::twist(0.5)),
                              .sweeps = {}};
      for (std::size_t i = kWayOut; i < 2 * kWayOut; ++i) {
        drive.truth[i].pose =
            drive.truth[2 * kWayOut - 1 - i].pose * Eigen::Translation3d(0.0, 0.3, 0.0);
      }
      drive.sweeps = test::scan_all(test::make_street(60.0), drive.truth, test::small_lidar());
      test::TemporaryMap map;
      const auto slam =
          make_slam(context(), test::loop_config(false),
                    {.inertial = false, .map = &map.store(), .session = map.session()});
      for (const Sweep& sweep : drive.sweeps) {
        slam->add(sweep);
        while (slam->next()) {
        }
      }
      slam->finish_map();
      std::vector<Recorded> made;
      Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
      const PoseGraph graph = map.store().graph();
      for (const MapKeyframe& keyframe : map.store().keyframes()) {
        Recorded one{.keyframe = keyframe, .submap = decode(map.store().submap(keyframe.id))};
        const auto at = std::ranges::find(drive.truth, keyframe.stamp, &StampedPose::stamp);
        one.truth = at->pose * one.submap.sweeps.front().T_keyframe_lidar.inverse();
        start = made.empty() ? one.truth : start;
        one.truth = start.inverse() * one.truth;
        for (const PoseEdge& edge : graph.edges()) {
          if (edge.to == keyframe.id) {
            one.edge = edge;
          }
        }
        made.push_back(std::move(one));
      }
      return made;
    }();
    return recorded;
  }

  struct Result {
    std::vector<Eigen::Isometry3d> odometry;
    std::vector<Eigen::Isometry3d> map;
    PoseGraph graph;
    LoopReport loops;
    std::optional<NodeId> outgrown;
    std::string dump;
  };

  /// `drift` is put into each edge for a metre of its way; nothing ties the keyframe `part` to the
  /// one before, and after it the odometry's axes are others.
  static Result assembled(double yaw, double climb, std::optional<std::size_t> part = {},
                          const Tilting& tilting = {}, const MapMemory& memory = {}) {
    test::TemporaryMap map;
    MapAssembly assembly(context(), test::loop_config(true), map.store(), memory);
    Result result;
    Eigen::Isometry3d T_odom_keyframe = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < std::min(street().size(), tilting.keyframes); ++i) {
      Recorded one = street()[i];
      one.submap.vertical = tilting.levelled ? Vertical::gravity : one.submap.vertical;
      std::optional<PoseEdge> edge = part == i ? std::nullopt : one.edge;
      if (edge) {
        const double metres = edge->T_from_to.translation().norm();
        edge->T_from_to.linear() *=
            Eigen::AngleAxisd(yaw * metres, Eigen::Vector3d::UnitZ()).toRotationMatrix();
        edge->T_from_to.linear() *=
            Eigen::AngleAxisd(tilting.pitch * metres, Eigen::Vector3d::UnitY()).toRotationMatrix();
        edge->T_from_to.translation().z() += climb * metres;
        T_odom_keyframe = T_odom_keyframe * edge->T_from_to;
      } else if (i > 0) {
        T_odom_keyframe = Eigen::Isometry3d(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()));
      }
      result.odometry.push_back(T_odom_keyframe);
      const SurfaceCloud cloud = make_surface_cloud(context(), one.submap);
      MapKeyframe keyframe = one.keyframe;
      keyframe.session = map.session();
      assembly.add({.keyframe = keyframe,
                    .T_odom_keyframe = T_odom_keyframe,
                    .submap = &one.submap,
                    .cloud = &cloud,
                    .edge = edge});
    }
    assembly.finish();
    result.map = poses_of(assembly.graph());
    result.graph = map.store().graph();
    result.loops = *assembly.loops();
    result.outgrown = assembly.outgrown();
    result.dump = map.dump();
    return result;
  }

  /// Rms distance from the truth, the first keyframe being where it was, m.
  static double error_of(const std::vector<Eigen::Isometry3d>& poses) {
    double sum = 0.0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      sum += ((poses.front().inverse() * poses[i]).translation() - street()[i].truth.translation())
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(poses.size() - 1));
  }

  static void expect_right_loops(const PoseGraph& graph) {
    for (const PoseEdge& edge : graph.edges()) {
      if (edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active) {
        const auto truth = [](NodeId id) { return street()[static_cast<std::size_t>(id)].truth; };
        const Eigen::Isometry3d off =
            edge.T_from_to.inverse() * truth(edge.from).inverse() * truth(edge.to);
        EXPECT_LT(off.translation().norm(), 0.2) << edge.from << " to " << edge.to;
        EXPECT_LT(rotation_angle(off.linear()), 0.02);
      }
    }
  }
};

// Twice the drift that is usual. Part of it is left: the graph knows nothing of gravity and tilts
// the street to explain part of the climb.
TEST_F(MapAssemblyTest, LoopsTakeOutADriftThatTheCovariancesKnowNothingOf) {
  const Result drifted = assembled(0.03 * std::numbers::pi / 180.0, 0.03);
  EXPECT_GT(error_of(drifted.odometry), 0.5);
  EXPECT_LT(error_of(drifted.map), 0.4 * error_of(drifted.odometry));
  EXPECT_GE(drifted.loops.accepted, 4U);
  EXPECT_GE(drifted.loops.by_appearance, drifted.loops.accepted_by_appearance);
  expect_right_loops(drifted.graph);
}

// All that the odometry says is kept; only what would take more memory is left out.
TEST_F(MapAssemblyTest, AGraphThatHasOutgrownItsMemoryIsOptimizedNoMore) {
  const MapMemory memory{.graph_bytes = 10 * MapMemory::kBytesANode};
  const Result held = assembled(0.0, 0.0, {}, {.pitch = 0.005, .levelled = true}, memory);
  EXPECT_EQ(held.outgrown, 10);
  EXPECT_EQ(held.loops.candidates, 0U);
  EXPECT_EQ(held.loops.optimizations, 0U);
  EXPECT_EQ(held.map.size(), street().size());
  EXPECT_EQ(error_of(held.map), error_of(held.odometry));
  EXPECT_EQ(assembled(0.0, 0.0).outgrown, std::nullopt);
}

TEST_F(MapAssemblyTest, PartsThatNothingTiesAreJoinedByWhatTheyHaveInCommon) {
  const std::size_t part = street().size() / 2;
  const Result parted = assembled(0.0, 0.0, part);
  EXPECT_EQ(connected_components(parted.graph).components.size(), 1U);
  EXPECT_LT(error_of(parted.map), 0.2);
  EXPECT_GE(parted.loops.accepted_by_appearance, 4U);
  expect_right_loops(parted.graph);
  EXPECT_EQ(assembled(0.0, 0.0, part).dump, parted.dump) << "the same bytes twice";
}

// There is no loop on the way out: what verticals say of it counts once the map is finished. It is
// little here, since 25 of them know less than edges that claim to be stiff.
TEST_F(MapAssemblyTest, VerticalsStraightenAWayWithoutLoops) {
  const std::size_t way_out = street().size() / 2;
  const Result bent = assembled(0.0, 0.0, {}, {.pitch = 0.005, .keyframes = way_out});
  EXPECT_GT(error_of(bent.odometry), 0.5);
  EXPECT_EQ(error_of(bent.map), error_of(bent.odometry));
  const Result straight =
      assembled(0.0, 0.0, {}, {.pitch = 0.005, .levelled = true, .keyframes = way_out});
  EXPECT_LT(error_of(straight.map), 0.98 * error_of(bent.odometry));
}

}  // namespace
}  // namespace adit
