// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/initialization.hpp"

#include <gtest/gtest.h>

#include "adit/slam/graph/solver.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;

/// A graph whose edges fit exactly and whose poses are all wrong but for the fixed one.
SimulatedGraph exact_graph(bool planar) {
  SimulatedGraph simulated = simulated_graph({.nodes = 600,
                                              .loops = 60,
                                              .seed = 2,
                                              .planar = planar,
                                              .odometry_sigma = 1e-9,
                                              .odometry_angle_sigma = 1e-9,
                                              .loop_sigma = 1e-9,
                                              .loop_angle_sigma = 1e-9});
  for (const PoseNode& node : std::vector<PoseNode>(simulated.graph.nodes())) {
    simulated.graph.set_pose(node.id, step(3.0, 1.0));
  }
  simulated.graph.set_pose(300, simulated.truth[300]);
  simulated.graph.set_fixed(300, true);
  return simulated;
}

TEST(InitialPoses, AreTheTruthWhereEdgesAreExact) {
  for (const bool planar : {false, true}) {
    const SimulatedGraph simulated = exact_graph(planar);
    EXPECT_LT(test::largest_difference(spanning_tree_poses(simulated.graph), simulated.truth),
              1e-5);
    EXPECT_LT(test::largest_difference(chordal_poses(simulated.graph), simulated.truth), 1e-5);
  }
}

TEST(InitialPoses, TheTreeTakesTheBestEdges) {
  PoseGraph graph;
  for (const NodeId id : {0, 1, 2}) {
    graph.add_node({.id = id});
  }
  graph.add_edge(edge(0, 1, step(1.0), 1000.0));
  graph.add_edge(edge(1, 2, step(1.0), 1000.0));
  graph.add_edge(edge(2, 0, step(-5.0), 1.0));
  EXPECT_NEAR(spanning_tree_poses(graph)[2].translation().x(), 2.0, 1e-12);
  graph.set_status(1, EdgeStatus::revoked);
  EXPECT_NEAR(spanning_tree_poses(graph)[2].translation().x(), 5.0, 1e-12);
}

TEST(InitialPoses, PartsAndLoneNodesStayInTheirPlaces) {
  PoseGraph graph;
  for (const NodeId id : {0, 1, 5, 6, 9}) {
    graph.add_node({.id = id, .T_map_node = step(10.0 * static_cast<double>(id))});
  }
  graph.add_edge(edge(0, 1, step(1.0)));
  graph.add_edge(edge(5, 6, step(2.0)));
  for (const auto& poses : {spanning_tree_poses(graph), chordal_poses(graph)}) {
    EXPECT_NEAR(poses[1].translation().x(), 1.0, 1e-9);
    EXPECT_EQ(poses[2].translation().x(), 50.0);
    EXPECT_NEAR(poses[3].translation().x(), 52.0, 1e-9);
    EXPECT_EQ(poses[4].translation().x(), 90.0);
  }
}

TEST(InitialPoses, EdgesThatKnowNothingGiveATreeInsteadOfASingularSystem) {
  PoseGraph graph;
  for (const NodeId id : {0, 1, 2}) {
    graph.add_node({.id = id});
  }
  graph.add_edge(edge(0, 1, step(1.0), 0.0));
  graph.add_edge(edge(1, 2, step(1.0)));
  EXPECT_NEAR(chordal_poses(graph)[2].translation().x(), 2.0, 1e-3);
}

// Noise so large that dead reckoning has turned round several times.
TEST(InitialPoses, ChordalOnesLeadToTheMinimumWhereTheFilesDoNot) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    SimulatedGraph simulated = simulated_graph({.nodes = 2000,
                                                .loops = 600,
                                                .seed = seed,
                                                .odometry_sigma = 0.05,
                                                .odometry_angle_sigma = 0.03,
                                                .loop_angle_sigma = 0.03});
    PoseGraph graph = simulated.graph;
    graph.set_poses(chordal_poses(graph));
    const OptimizedGraph chordal = optimize(graph, {});
    EXPECT_EQ(chordal.report.termination, Termination::converged);
    const double degrees = 6.0 * (static_cast<double>(graph.edges().size()) - 1999.0);
    EXPECT_NEAR(chordal.report.cost_after, degrees, 0.2 * degrees) << seed;
  }
}

}  // namespace
}  // namespace adit
