// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the end of a map makes of an antenna that sits elsewhere and of a receiver that is late.
#include <gtest/gtest.h>

#include "adit/slam/gnss/gnss_constraints.hpp"
#include "adit/tests/mapping/antenna_drive.hpp"

namespace adit {
namespace {

constexpr double kDuration = 100.0;  // s
const Geodetic kStart{41.65, -0.88, 200.0};

struct Finished {
  GnssReport report;
  std::vector<MapFix> fixes;
  double error = 0.0;  ///< m, of the map in the world, rms
};

/// The map grows node by node, as MapAssembly has it.
Finished mapped(const test::AntennaDrive& drive, const GnssConfig& config = {}) {
  const WorldFrame frame(kStart);
  Finished finished;
  finished.fixes = drive.map_fixes(frame);
  GnssConstraints ties(config);
  for (const StampedPose& pose : drive.odometry()) {
    ties.add_pose(pose, false);
  }
  PoseGraph graph;
  std::optional<Georeference> georeference;
  const auto keep = [&](const GnssConstraints::Change& change) {
    for (const MapFix& fix : change.fixes) {
      finished.fixes[static_cast<std::size_t>(fix.id) - 1] = fix;
    }
    georeference = change.georeference ? change.georeference : georeference;
  };
  const std::vector<MapFix> fixes = finished.fixes;
  for (const PoseNode& node : drive.graph().nodes()) {
    graph.add_node(node);
    graph.add_level({.node = node.id, .information = 2500.0});
    if (node.id > 0) {
      const PoseEdge& edge = drive.graph().edges()[static_cast<std::size_t>(node.id) - 1];
      graph.add_edge(edge);
      graph.set_pose(
          node.id, graph.nodes()[static_cast<std::size_t>(edge.from)].T_map_node * edge.T_from_to);
    }
    std::vector<MapFix> of_node;
    std::ranges::copy_if(fixes, std::back_inserter(of_node),
                         [&](const MapFix& fix) { return fix.keyframe == node.id; });
    ties.add(of_node);
    keep(ties.take_effect(graph, node.id));
  }
  keep(ties.finish(graph));
  finished.report = ties.report();
  if (georeference) {
    // From where the map lies in its own frame to the drive's world.
    Eigen::Isometry3d T_drive_world = Eigen::Isometry3d::Identity();
    T_drive_world.translation() = frame.position_of(georeference->origin);
    finished.error = drive.world_error(graph, T_drive_world * georeference->T_world_map);
  }
  return finished;
}

AntennaError found(const GnssReport& report) {
  AntennaError error;
  for (int i = 0; i < 4; ++i) {
    error(i) = report.antenna.parameters[static_cast<std::size_t>(i)].value;
  }
  return error;
}

void expect_set_right(const AntennaError& truth, unsigned seeds) {
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const test::AntennaDrive drive(
        test::in_town(), kDuration,
        {.antenna = truth, .fix_sigma = 0.012, .edge_sigma = 0.02, .outliers = 0.05}, seed);
    const Finished finished = mapped(drive);
    ASSERT_TRUE(finished.report.antenna.estimated) << seed;
    EXPECT_TRUE(finished.report.antenna.corrected) << seed;
    EXPECT_LT(finished.error, 0.1) << seed;
    EXPECT_LT((found(finished.report) - truth).head<2>().norm(), 0.1) << seed;
    EXPECT_NEAR(found(finished.report)(kDelay), truth(kDelay), 0.01) << seed;
    EXPECT_NEAR(finished.report.antenna.time_offset, -found(finished.report)(kDelay), 0.01) << seed;
  }
}

TEST(AntennaCorrection, AWrongLeverArmIsSetRight) {
  expect_set_right({0.42, -0.15, 0.0, 0.0}, 5);
}

TEST(AntennaCorrection, ALateReceiverIsSetRight) {
  expect_set_right({0.0, 0.0, 0.0, 0.12}, 5);
}

TEST(AntennaCorrection, WhatIsSoWrongThatNoPlaceFitsIsSetRight) {
  expect_set_right({3.0, 1.0, 0.0, 0.3}, 2);
  expect_set_right({0.0, 0.0, 0.0, 1.0}, 2);
}

TEST(AntennaCorrection, NothingIsCorrectedWhereNothingIsWrong) {
  for (const double sigma : {0.012, 0.3, 1.5}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const test::AntennaDrive drive(test::in_town(), kDuration,
                                     {.fix_sigma = sigma, .edge_sigma = 0.02, .outliers = 0.05},
                                     seed);
      const Finished finished = mapped(drive);
      if (finished.report.antenna.estimated) {
        EXPECT_FALSE(finished.report.antenna.any_significant()) << seed;
        EXPECT_FALSE(finished.report.antenna.corrected) << seed;
      }
      EXPECT_EQ(finished.report.antenna.estimated, finished.report.georeference.has_value());
    }
  }
}

TEST(AntennaCorrection, ErrorsOfOtherKindsThanTheModelsAreNotTheAntennas) {
  const test::AntennaDrive::Errors usual{.fix_sigma = 0.3, .edge_sigma = 0.02, .outliers = 0.05};
  for (unsigned seed = 1; seed <= 2; ++seed) {
    for (const double correlation : {3.0, 600.0}) {
      test::AntennaDrive::Errors errors = usual;
      errors.correlation = correlation;
      const Finished finished =
          mapped(test::AntennaDrive(test::in_town(), kDuration, errors, seed));
      EXPECT_FALSE(finished.report.antenna.corrected) << correlation << " " << seed;
    }
    for (const double multipath : {0.25, 2.0}) {
      test::AntennaDrive::Errors errors = usual;
      errors.multipath = multipath;
      errors.fix_sigma = 0.012;
      const Finished finished =
          mapped(test::AntennaDrive(test::in_town(), kDuration, errors, seed));
      EXPECT_FALSE(finished.report.antenna.corrected) << multipath << " " << seed;
    }
  }
}

}  // namespace
}  // namespace adit
