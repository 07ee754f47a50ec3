// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/local_optimization.hpp"

#include <gtest/gtest.h>

#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::line;
using test::step;

TEST(LocalOptimization, TakesTheNodesTheirNeighboursAndTheEdgesThatTouchThem) {
  PoseGraph graph = line(10);
  graph.add_edge(edge(1, 9, step(8.0)));
  graph.add_edge(edge(1, 5, step(4.0)));  // between neighbours: left out
  const PoseGraph part = neighbourhood(graph, std::vector<NodeId>{7, 8, 9});
  ASSERT_EQ(part.nodes().size(), 5U);
  EXPECT_TRUE(part.nodes()[part.index_of(1)].fixed);
  EXPECT_TRUE(part.nodes()[part.index_of(6)].fixed);
  EXPECT_FALSE(part.nodes()[part.index_of(7)].fixed);
  EXPECT_EQ(part.edges().size(), 4U);
}

TEST(LocalOptimization, MovesTheNewestNodesAlone) {
  PoseGraph graph = line(20);
  const LocalOptimization still = optimize_newest(graph, 5, {});
  EXPECT_EQ(still.report.termination, Termination::nothing_to_do);
  EXPECT_EQ(still.nodes, (std::vector<NodeId>{14, 15, 16, 17, 18, 19}));

  graph.add_edge(edge(0, 19, step(19.7)));
  const LocalOptimization moved = optimize_newest(graph, 5, {});
  EXPECT_EQ(moved.report.termination, Termination::converged);
  // The seven edges from node 13 to 19 and on to node 0 share 0.7 m.
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(moved.poses[i].translation().x(), 14.0 + static_cast<double>(i) * 1.1 + 0.1, 1e-6);
  }
}

TEST(LocalOptimization, IsThatOfTheWholeGraphWithAllOthersFixed) {
  const SimulatedGraph simulated = simulated_graph({.nodes = 900, .loops = 200, .seed = 4});
  PoseGraph fixed = simulated.graph;
  for (std::size_t i = 0; i + 41 < fixed.nodes().size(); ++i) {
    fixed.set_fixed(fixed.nodes()[i].id, true);
  }
  const OptimizationSettings settings{.odometry_kernel = {.kernel = Kernel::pseudo_huber},
                                      .loop_kernel = {.kernel = Kernel::pseudo_huber}};
  const LocalOptimization local = optimize_newest(simulated.graph, 40, settings);
  const OptimizedGraph whole = optimize(fixed, settings);
  EXPECT_EQ(local.report.termination, Termination::converged);
  for (std::size_t i = 0; i < local.nodes.size(); ++i) {
    const auto node = simulated.graph.index_of(local.nodes[i]);
    EXPECT_LT((local.poses[i].matrix() - whole.poses[node].matrix()).cwiseAbs().maxCoeff(), 1e-4);
  }
}

// As a run has it: the newest keyframes are a chain behind the last loop, and each bundle of loops
// is followed by an optimisation of the whole (docs/decisions/0024).
TEST(LocalOptimization, HasNothingLeftToDoBehindAnOptimisationOfTheWhole) {
  PoseGraph graph = simulated_graph({.nodes = 900, .loops = 200, .seed = 4}).graph;
  graph.set_poses(optimize_with_loops(graph).poses);
  const OptimizationSettings settings{
      .odometry_kernel = {.kernel = Kernel::pseudo_huber, .width = 1.0},
      .loop_kernel = {.kernel = Kernel::dcs}};
  for (int more = 0; more < 4; ++more) {
    const LocalOptimization local = optimize_newest(graph, 5, settings);
    for (std::size_t i = 0; i < local.nodes.size(); ++i) {
      const PoseNode& node = graph.nodes()[graph.index_of(local.nodes[i])];
      EXPECT_LT((local.poses[i].translation() - node.T_map_node.translation()).norm(), 1e-4) << "m";
    }
    const PoseNode last = graph.nodes().back();
    graph.add_node({.id = last.id + 1, .T_map_node = last.T_map_node * step(0.7, 0.1)});
    graph.add_edge(edge(last.id, last.id + 1, step(0.7, 0.1)));
  }
}

// The graph has grown by five nodes and one is gone while the snapshot was optimised.
TEST(GraphCorrections, WhatCameMeanwhileKeepsItsPlaceBehindTheLastNode) {
  const SimulatedGraph simulated = simulated_graph({.nodes = 500, .loops = 60, .seed = 6});
  const PoseGraph& whole = simulated.graph;
  PoseGraph snapshot;
  PoseGraph grown;
  for (const PoseNode& node : whole.nodes()) {
    if (node.id < 495) {
      snapshot.add_node(node);
    }
    if (node.id != 100) {
      grown.add_node(node);
    }
  }
  for (const PoseEdge& each : whole.edges()) {
    if (std::max(each.from, each.to) < 495) {
      snapshot.add_edge(each);
    }
  }
  const OptimizedGraph optimized = optimize(snapshot, {});
  const PoseGraph result = corrected(grown, correction(snapshot, optimized));
  EXPECT_EQ(result.nodes()[result.index_of(300)].T_map_node.matrix(),
            optimized.poses[300].matrix());
  const auto pose = [](const PoseGraph& graph, NodeId id) {
    return graph.nodes()[graph.index_of(id)].T_map_node;
  };
  for (NodeId id = 495; id < 500; ++id) {
    EXPECT_LT(((pose(result, id - 1).inverse() * pose(result, id)).matrix() -
               (pose(whole, id - 1).inverse() * pose(whole, id)).matrix())
                  .cwiseAbs()
                  .maxCoeff(),
              1e-9)
        << id;
  }
  EXPECT_GT((pose(result, 499).matrix() - pose(whole, 499).matrix()).norm(), 0.01);
}

}  // namespace
}  // namespace adit
