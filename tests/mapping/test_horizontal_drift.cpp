// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/horizontal_drift.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

constexpr double kPlaceError = 0.01;  // m, an edge, as the odometry has it
constexpr double kHeading = 0.001;    // rad
constexpr double kFixSigma = 0.02;

/// A way round in the level, five times over, whose odometry errs by `error` times what it says; a
/// fix a node.
struct Drive {
  PoseGraph graph;
  std::vector<Eigen::Isometry3d> truth;
};

Drive drive(double error, double fix_sigma, unsigned seed, double height_error = 1.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  Drive made;
  const Matrix6d information = test::diagonal_covariance(kPlaceError, kHeading).inverse();
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  for (NodeId id = 0; id < 300; ++id) {
    Eigen::Isometry3d measured = test::step(2.0, 0.1);
    truth = id > 0 ? truth * measured : truth;
    Vector6d by;
    by << error * kPlaceError * Eigen::Vector2d(noise(random), noise(random)),
        height_error * kPlaceError * noise(random),
        height_error * kHeading * Eigen::Vector2d(noise(random), noise(random)),
        error * kHeading * noise(random);
    measured = measured * se3_exp(by);
    made.truth.push_back(truth);
    made.graph.add_node(
        {.id = id, .T_map_node = id > 0 ? made.graph.nodes().back().T_map_node * measured : truth});
    made.graph.add_level({.node = id, .information = 2500.0});
    if (id > 0) {
      PoseEdge edge = test::edge(id - 1, id, measured);
      edge.information = information;
      made.graph.add_edge(edge);
    }
    const Eigen::Vector3d sigma(fix_sigma, fix_sigma, 2.0 * fix_sigma);
    const Eigen::Vector3d off(noise(random), noise(random), noise(random));
    made.graph.add_fix({.node = id,
                        .p_node = Eigen::Vector3d(0.1, 0.2, 1.5),
                        .p_world = truth * Eigen::Vector3d(0.1, 0.2, 1.5) + sigma.cwiseProduct(off),
                        .information = sigma.cwiseAbs2().cwiseInverse().asDiagonal()});
  }
  return made;
}

PoseGraph optimum_of(const PoseGraph& graph) {
  const OptimizedGraph optimum = optimize(graph, loop_kernels());
  PoseGraph placed = graph;
  placed.set_poses(optimum.poses);
  placed.set_T_world_map(optimum.T_world_map);
  return placed;
}

/// Of nodes' level places in the map, the first held, m.
double level_error(const Drive& made, const std::vector<Eigen::Isometry3d>& poses) {
  double sum = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sum += (poses[i].translation() - made.truth[i].translation()).head<2>().squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

TEST(HorizontalDrift, GoodFixesTellIt) {
  for (const double error : {0.1, 0.3, 1.0, 3.0}) {
    for (const double height_error : {1.0, 3.0}) {
      for (unsigned seed = 1; seed <= 5; ++seed) {
        const Drive made = drive(error, kFixSigma, seed, height_error);
        const HorizontalDrift found = horizontal_drift(optimum_of(made.graph));
        EXPECT_LE(found.smallest, 2.0 * error * error) << error << ", seed " << seed;
        EXPECT_GE(found.smallest, 0.2 * error * error) << error << ", seed " << seed;
        // Kernels leave large errors of edges less than these say.
        EXPECT_GE(found.largest, 0.3 * error * error) << error << ", seed " << seed;
        EXPECT_LE(found.largest, 5.0 * error * error) << error << ", seed " << seed;
      }
    }
  }
}

TEST(HorizontalDrift, PoorFixesRuleNothingOutAndBendNothingThatIsBetter) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Drive made = drive(0.1, 3.0, seed);
    EXPECT_GE(horizontal_drift(optimum_of(made.graph)).largest, 1.0) << seed;
    const double alone = level_error(made, poses_of(made.graph));
    const LoopOptimum bent = optimize_with_loops(made.graph);
    EXPECT_LE(level_error(made, bent.poses), 1.5 * alone + 0.01)
        << "seed " << seed << ", drift counted " << bent.level_drift_scale << " times";
  }
}

TEST(HorizontalDrift, WhatTellsNothingLeavesTheOdometryAsItIs) {
  Drive made = drive(0.1, kFixSigma, 1);
  PoseGraph without_levels;
  for (const PoseNode& node : made.graph.nodes()) {
    without_levels.add_node(node);
  }
  std::ranges::for_each(made.graph.edges(), [&](const PoseEdge& e) { without_levels.add_edge(e); });
  std::ranges::for_each(made.graph.fixes(),
                        [&](const PositionFix& f) { without_levels.add_fix(f); });
  const PositionFix only = made.graph.fixes()[100];
  made.graph.clear_fixes();
  PoseGraph with_one = made.graph;
  with_one.add_fix(only);
  for (const PoseGraph& graph : {without_levels, made.graph, with_one}) {
    EXPECT_EQ(horizontal_drift(graph).smallest, 1.0);
    EXPECT_EQ(horizontal_drift(graph).largest, 1.0);
    EXPECT_EQ(optimize_with_loops(graph).level_drift_scale, 1.0);
  }
}

TEST(HorizontalDrift, ScalesTheLevelOfUsualEdgesAlone) {
  PoseGraph graph = test::line(4);
  PoseEdge unusual = test::edge(3, 4, test::step(1.0));
  unusual.information(0, 0) /= 100.0;
  graph.add_node({.id = 4, .T_map_node = test::step(4.0)});
  graph.add_edge(unusual);
  graph.add_edge(test::edge(4, 0, test::step(-4.0)));
  // The map's x axis points up in the world, so that its y and z are level.
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();
  T_world_map.linear() = Eigen::AngleAxisd(-0.5 * kPi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  graph.set_T_world_map(T_world_map);
  const PoseGraph scaled = with_horizontal_drift(graph, 0.01);
  Vector6d expected;
  expected << 1e2, 1e4, 1e4, 1e4, 1e2, 1e2;
  EXPECT_TRUE(scaled.edges()[0].information.isApprox(Matrix6d(expected.asDiagonal()), 1e-9))
      << scaled.edges()[0].information;
  EXPECT_EQ(scaled.edges()[4].information, graph.edges()[4].information) << "a loop";

  graph.set_T_world_map(Eigen::Isometry3d::Identity());
  EXPECT_EQ(with_horizontal_drift(graph, 0.01).edges()[3].information, unusual.information);
}

}  // namespace
}  // namespace adit
