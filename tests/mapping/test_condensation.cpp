// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/condensation.hpp"

#include <gtest/gtest.h>

#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::line;
using test::step;

TEST(Condensation, AChainIsOneEdgeWithTheSumOfItsCovariances) {
  PoseGraph graph = line(5);
  graph.add_edge(edge(0, 4, step(4.5)));
  const CondensedGraph small = condensed(graph, ResidualConvention::rotation);
  ASSERT_EQ(small.graph.nodes().size(), 2U);
  ASSERT_EQ(small.chains.size(), 1U);
  EXPECT_EQ(small.chains[0].nodes, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  const PoseEdge& whole = small.graph.edges().back();
  EXPECT_NEAR(whole.T_from_to.translation().x(), 4.0, 1e-12);
  EXPECT_NEAR(whole.information(0, 0), 25.0, 1e-9);  // four times the variance of one
  EXPECT_NEAR(whole.information(3, 3), 25.0, 1e-9);
  // Across, rotations swing the end by 3, 2, 1 and 0 m.
  EXPECT_NEAR(whole.information.inverse()(1, 1), 0.01 * (4.0 + 9.0 + 4.0 + 1.0), 1e-9);
}

TEST(Condensation, WhatIsFixedOrNotOdometryOrKnowsTooLittleStays) {
  PoseGraph graph = line(9);
  graph.set_fixed(2, true);
  PoseEdge loop = edge(3, 8, step(5.0));
  graph.add_edge(loop);
  PoseGraph weak;
  for (const PoseNode& node : graph.nodes()) {
    weak.add_node(node);
  }
  for (PoseEdge each : graph.edges()) {
    if (each.from == 5 && each.to == 6) {
      each.information(0, 0) = 0.0;
    }
    weak.add_edge(each);
  }
  const CondensedGraph small = condensed(weak, ResidualConvention::rotation);
  std::vector<NodeId> left;
  for (const PoseNode& node : small.graph.nodes()) {
    left.push_back(node.id);
  }
  // 1 and 4 and 7 lie inside chains; 5 and 6 have an edge that does not know a direction.
  EXPECT_EQ(left, (std::vector<NodeId>{0, 2, 3, 5, 6, 8}));
}

TEST(Condensation, ARingIsCutInItsMiddle) {
  PoseGraph graph = line(6);
  PoseEdge closing = edge(5, 0, step(-5.0));
  closing.kind = EdgeKind::odometry;
  graph.add_edge(closing);
  const CondensedGraph small = condensed(graph, ResidualConvention::rotation);
  EXPECT_EQ(small.graph.nodes().size(), 2U);
  EXPECT_EQ(small.chains.size(), 2U);
}

// The same minimum as without, in all conventions and in the plane; and the condensed graph's own
// is close to it.
TEST(Condensation, LeadsToTheSameMinimum) {
  for (const bool planar : {false, true}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const SimulatedGraph simulated =
          simulated_graph({.nodes = 4000, .loops = 200, .seed = seed, .planar = planar});
      for (const ResidualConvention convention :
           {ResidualConvention::quaternion, ResidualConvention::rotation,
            ResidualConvention::logarithm}) {
        const OptimizationSettings settings{.convention = convention};
        const OptimizedGraph direct = optimize(simulated.graph, settings);
        const OptimizedGraph by_chains = optimize_condensed(simulated.graph, settings, 100);
        EXPECT_NEAR(by_chains.report.cost_after, direct.report.cost_after,
                    1e-8 * direct.report.cost_after);
        EXPECT_LT(test::largest_difference(by_chains.poses, direct.poses), 1e-3);

        const CondensedGraph small = condensed(simulated.graph, convention);
        EXPECT_LT(small.graph.nodes().size(), 500U);
        PoseGraph spread = simulated.graph;
        spread.set_poses(
            expanded(simulated.graph, small, optimize(small.graph, settings).poses, convention));
        EXPECT_LT(graph_cost(spread, settings), 1.05 * direct.report.cost_after) << seed;
      }
    }
  }
}

TEST(Condensation, IsLeftOutForSmallGraphs) {
  const SimulatedGraph simulated = simulated_graph({.nodes = 1000, .loops = 50, .seed = 1});
  const OptimizedGraph direct = optimize(simulated.graph, {});
  const OptimizedGraph other = optimize_condensed(simulated.graph, {}, 20000);
  EXPECT_EQ(test::largest_difference(direct.poses, other.poses), 0.0);
}

}  // namespace
}  // namespace adit
