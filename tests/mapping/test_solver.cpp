// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/solver.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "adit/slam/graph/graph_residuals.hpp"
#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tests/support/numerical_jacobian.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;

// Three nodes on a line; what is measured from the first to the last disagrees with the odometry by
// 0.3 m. Each of the three edges, equally certain, takes a third.
PoseGraph triangle() {
  PoseGraph graph;
  for (NodeId id = 0; id < 3; ++id) {
    graph.add_node({.id = id, .T_map_node = step(static_cast<double>(id))});
  }
  graph.add_edge(edge(0, 1, step(1.0)));
  graph.add_edge(edge(1, 2, step(1.0)));
  graph.add_edge(edge(0, 2, step(2.3)));
  return graph;
}

TEST(PoseGraphSolver, SharesAnErrorOutAndReportsIt) {
  const OptimizedGraph result = optimize(triangle(), {});
  EXPECT_EQ(result.report.termination, Termination::converged);
  EXPECT_NEAR(result.poses[1].translation().x(), 1.1, 1e-9);
  EXPECT_NEAR(result.poses[2].translation().x(), 2.2, 1e-9);
  EXPECT_EQ(result.report.held, std::vector<NodeId>{0});
  EXPECT_NEAR(result.report.cost_before, 9.0, 1e-12);
  EXPECT_NEAR(result.report.cost_after, 3.0, 1e-9);
  for (const auto& edge : result.report.edges) {
    EXPECT_NEAR(edge->chi2, 1.0, 1e-8);
  }
}

Eigen::Isometry3d random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto vector = [&] { return Eigen::Vector3d(any(random), any(random), any(random)); };
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = so3_exp(2.0 * vector());
  pose.translation() = 10.0 * vector();
  return pose;
}

template <class Residual>
void expect_right_jacobians(const Residual& residual, const Eigen::Isometry3d& T_world_map,
                            const Eigen::Isometry3d& T_map_node) {
  constexpr int kRows = Residual::kRows;
  const auto tie = residual.linearized(T_world_map, T_map_node);
  const auto by_world = test::numerical_jacobian<kRows, 6>([&](const Vector6d& xi) {
    return residual.linearized(retract(T_world_map, xi), T_map_node).residual;
  });
  const auto by_node = test::numerical_jacobian<kRows, 6>([&](const Vector6d& xi) {
    return residual.linearized(T_world_map, retract(T_map_node, xi)).residual;
  });
  EXPECT_LT((tie.by_world - by_world).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((tie.by_node - by_node).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(PoseGraphSolver, TiesToTheWorldHaveRightJacobians) {
  std::mt19937 random(5);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Isometry3d world = random_pose(random);
    const Eigen::Isometry3d node = random_pose(random);
    const Eigen::Matrix3d root = random_pose(random).linear() + Eigen::Matrix3d::Identity();
    expect_right_jacobians(FixResidual({.p_node = random_pose(random).translation(),
                                        .p_world = random_pose(random).translation(),
                                        .information = root.transpose() * root}),
                           world, node);
    expect_right_jacobians(LevelResidual({.information = 7.0}), world, node);
  }
}

// A line that climbs as drift does, levelled by nothing but the fixes, and placed by them.
TEST(PoseGraphSolver, FixesPlaceTheMapAndStraightenIt) {
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();
  T_world_map.linear() = so3_exp(Eigen::Vector3d(0.01, -0.02, 2.0));
  T_world_map.translation() = Eigen::Vector3d(100.0, -50.0, 7.0);
  PoseGraph truth = test::line(30);
  PoseGraph graph;
  for (const PoseNode& node : truth.nodes()) {
    PoseNode drifted = node;
    drifted.T_map_node.translation().z() += 0.02 * static_cast<double>(node.id);
    graph.add_node(drifted);
    if (node.id > 0) {
      graph.add_edge(edge(node.id - 1, node.id, step(1.0)));
    }
    const Eigen::Vector3d arm(0.3, 0.1 * static_cast<double>(node.id % 5), 0.5);
    graph.add_fix({.node = node.id,
                   .p_node = arm,
                   .p_world = T_world_map * (node.T_map_node * arm),
                   .information = 1e4 * Eigen::Matrix3d::Identity()});
  }
  graph.set_T_world_map(Eigen::Isometry3d(Eigen::AngleAxisd(1.9, Eigen::Vector3d::UnitZ())));
  const OptimizedGraph result = optimize(graph, {});
  EXPECT_EQ(result.report.termination, Termination::converged);
  EXPECT_LT(test::largest_difference(result.poses, poses_of(truth)), 1e-5);
  EXPECT_LT((result.T_world_map.matrix() - T_world_map.matrix()).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_NEAR(result.report.cost_after, 0.0, 1e-9);
  EXPECT_GT(result.report.cost_before, 1e6);
}

TEST(PoseGraphSolver, LevelsTurnTheWorldAndLeaveTheRestOfItAlone) {
  const PoseGraph level = test::line(5);
  PoseGraph graph = level;
  const Eigen::Matrix3d tilt = so3_exp(Eigen::Vector3d(0.05, 0.1, 0.0));
  for (const PoseNode& node : level.nodes()) {
    Eigen::Isometry3d tilted = node.T_map_node;
    tilted.linear() = tilt;
    graph.set_pose(node.id, tilted);
    graph.add_level({.node = node.id, .information = 1e4});
  }
  PoseGraph straight;
  for (const PoseNode& node : graph.nodes()) {
    straight.add_node(node);
    straight.add_level({.node = node.id, .information = 1e4});
    if (node.id > 0) {
      const Eigen::Isometry3d& before =
          graph.nodes()[static_cast<std::size_t>(node.id) - 1].T_map_node;
      straight.add_edge(edge(node.id - 1, node.id, before.inverse() * node.T_map_node));
    }
  }
  const OptimizedGraph result = optimize(straight, {});
  EXPECT_LT(test::largest_difference(result.poses, poses_of(straight)), 1e-6);
  const Eigen::Vector3d up = result.T_world_map.linear() * tilt.col(2);
  EXPECT_NEAR(up.z(), 1.0, 1e-6);
  EXPECT_LT(result.T_world_map.translation().norm(), 1e-3);
}

TEST(PoseGraphSolver, LeavesFixedNodesAndInactiveEdgesAlone) {
  PoseGraph graph = triangle();
  graph.set_fixed(0, true);
  graph.set_fixed(2, true);
  graph.set_pose(2, step(2.2));
  const OptimizedGraph fixed = optimize(graph, {});
  EXPECT_NEAR(fixed.poses[1].translation().x(), 1.1, 1e-9);
  EXPECT_EQ(fixed.poses[2].matrix(), step(2.2).matrix());
  EXPECT_TRUE(fixed.report.held.empty());

  graph = triangle();
  graph.set_status(2, EdgeStatus::candidate);
  const OptimizedGraph open = optimize(graph, {});
  EXPECT_NEAR(open.poses[2].translation().x(), 2.0, 1e-9);
  EXPECT_FALSE(open.report.edges[2].has_value());
}

TEST(PoseGraphSolver, HasNothingToDoWhereNothingMoves) {
  const OptimizedGraph empty = optimize(PoseGraph(), {});
  EXPECT_EQ(empty.report.termination, Termination::nothing_to_do);
  PoseGraph graph = triangle();
  for (const NodeId id : {0, 1, 2}) {
    graph.set_fixed(id, true);
  }
  const OptimizedGraph still = optimize(graph, {});
  EXPECT_EQ(still.report.termination, Termination::nothing_to_do);
  EXPECT_NEAR(still.report.cost_after, 9.0, 1e-12);
  EXPECT_EQ(test::largest_difference(still.poses, poses_of(graph)), 0.0);
}

TEST(PoseGraphSolver, OptimisesDisconnectedPartsEachInItsPlace) {
  PoseGraph graph = triangle();
  for (NodeId id = 10; id < 13; ++id) {
    graph.add_node({.id = id, .T_map_node = step(50.0 + static_cast<double>(id))});
  }
  graph.add_edge(edge(10, 11, step(1.0)));
  graph.add_edge(edge(11, 12, step(1.0)));
  graph.add_edge(edge(10, 12, step(2.3)));
  graph.add_node({.id = 20, .T_map_node = step(-7.0)});
  const OptimizedGraph result = optimize(graph, {});
  EXPECT_EQ(result.report.held, (std::vector<NodeId>{0, 10, 20}));
  EXPECT_NEAR(result.poses[2].translation().x(), 2.2, 1e-9);
  EXPECT_NEAR(result.poses[3].translation().x(), 60.0, 0.0);
  EXPECT_NEAR(result.poses[5].translation().x(), 62.2, 1e-9);
  EXPECT_EQ(result.poses[6].translation().x(), -7.0);
}

TEST(PoseGraphSolver, KernelsTakeTheWeightFromAWrongLoop) {
  const SimulatedGraph simulated = simulated_graph({.nodes = 1200,
                                                    .loops = 150,
                                                    .seed = 3,
                                                    .odometry_sigma = 0.005,
                                                    .odometry_angle_sigma = 2e-4});
  PoseGraph graph = simulated.graph;
  PoseEdge wrong = graph.edges().back();
  ASSERT_EQ(wrong.kind, EdgeKind::loop);
  wrong.T_from_to.translation().x() += 30.0;
  graph.add_edge(wrong);
  const auto error = [&](Kernel kernel) {
    const OptimizedGraph result = optimize(graph, {.loop_kernel = {.kernel = kernel}});
    EXPECT_EQ(result.report.termination, Termination::converged);
    EXPECT_TRUE(kernel == Kernel::none || result.report.edges.back()->weight < 0.05);
    return position_rmse(result.poses, simulated.truth);
  };
  const double clean = position_rmse(optimize(simulated.graph, {}).poses, simulated.truth);
  EXPECT_GT(error(Kernel::none), 5.0 * clean);
  EXPECT_LT(error(Kernel::dcs), 1.5 * clean);
}

// A direction that no edge knows anything about neither moves nor stops the optimisation.
TEST(PoseGraphSolver, TakesInformationThatIsOnlySemidefinite) {
  PoseGraph graph = triangle();
  PoseGraph weak;
  for (const PoseNode& node : graph.nodes()) {
    weak.add_node(node);
  }
  for (PoseEdge edge : graph.edges()) {
    edge.information.row(2).setZero();
    edge.information.col(2).setZero();
    weak.add_edge(edge);
  }
  const OptimizedGraph result = optimize(weak, {});
  EXPECT_EQ(result.report.termination, Termination::converged);
  EXPECT_NEAR(result.poses[2].translation().x(), 2.2, 1e-6);
  EXPECT_NEAR(result.poses[2].translation().z(), 0.0, 1e-6);
}

std::vector<Eigen::Isometry3d> shuffled_and_optimised(const PoseGraph& graph, unsigned seed) {
  std::vector<PoseNode> nodes = graph.nodes();
  std::vector<PoseEdge> edges = graph.edges();
  std::mt19937 random(seed);
  std::ranges::shuffle(nodes, random);
  std::ranges::shuffle(edges, random);
  PoseGraph other(graph.planar());
  for (const PoseNode& node : nodes) {
    other.add_node(node);
  }
  for (const PoseEdge& edge : edges) {
    other.add_edge(edge);
  }
  return optimize(other, {}).poses;
}

TEST(PoseGraphSolver, TheOrderOfNodesAndEdgesDoesNotChangeAByte) {
  for (const bool planar : {false, true}) {
    SimulatedGraph simulated =
        simulated_graph({.nodes = 800, .loops = 100, .seed = 5, .planar = planar});
    PoseEdge twin = simulated.graph.edges().back();  // two edges between the same nodes
    twin.T_from_to.translation().x() += 0.01;
    simulated.graph.add_edge(twin);
    const std::vector<Eigen::Isometry3d> poses = optimize(simulated.graph, {}).poses;
    for (const unsigned seed : {1U, 2U, 3U}) {
      const auto other = shuffled_and_optimised(simulated.graph, seed);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        ASSERT_EQ(std::memcmp(poses[i].data(), other[i].data(), 16 * sizeof(double)), 0) << i;
      }
    }
  }
}

TEST(PoseGraphSolver, ConvergesFromDeadReckoningOverFiveSeeds) {
  for (const bool planar : {false, true}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const SimulatedGraph simulated =
          simulated_graph({.nodes = 3000, .loops = 300, .seed = seed, .planar = planar});
      const OptimizedGraph result = optimize(simulated.graph, {});
      EXPECT_EQ(result.report.termination, Termination::converged);
      EXPECT_LT(result.report.iterations, 30);
      // Chi squared of what is left over: as many degrees as rows less unknowns.
      const double freedom = planar ? 3.0 : 6.0;
      const double edges = static_cast<double>(simulated.graph.edges().size());
      const double degrees = freedom * (edges - 2999.0);
      EXPECT_NEAR(result.report.cost_after, degrees, 6.0 * std::sqrt(2.0 * degrees)) << seed;
      EXPECT_LT(position_rmse(result.poses, simulated.truth),
                position_rmse(poses_of(simulated.graph), simulated.truth));
    }
  }
}

TEST(PoseGraphSolver, EndsWhereTheCallerWantsIt) {
  const SimulatedGraph simulated = simulated_graph({.nodes = 800, .loops = 100, .seed = 5});
  OptimizationSettings settings;
  int calls = 0;
  settings.on_step = [&](const OptimizationStep& at) {
    EXPECT_EQ(at.iteration, calls);
    return ++calls < 3;
  };
  const OptimizedGraph result = optimize(simulated.graph, settings);
  EXPECT_EQ(result.report.termination, Termination::stopped);
  EXPECT_EQ(result.report.iterations, 2);
  settings.on_step = nullptr;
  settings.max_iterations = 1;
  EXPECT_EQ(optimize(simulated.graph, settings).report.termination, Termination::iteration_limit);
}

TEST(PoseGraphSolver, PrintsNothing) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  PoseGraph hopeless = triangle();
  PoseEdge absurd = edge(0, 2, step(1e8, 3.0), 1e14);
  hopeless.add_edge(absurd);
  static_cast<void>(optimize(hopeless, {.max_iterations = 5}));
  static_cast<void>(optimize(triangle(), {.max_iterations = 0}));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace adit
