// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/implied_drift.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/graph/relative_poses.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::step;
using test::up;

constexpr double kWellKnown = 1e6;  // 1/m^2 and 1/rad^2, of an edge

PoseEdge known_edge(NodeId from, NodeId to, const Eigen::Isometry3d& T_from_to) {
  return test::edge(from, to, T_from_to, kWellKnown);
}

PoseGraph known_line(NodeId nodes) {
  PoseGraph graph;
  for (NodeId id = 0; id < nodes; ++id) {
    graph.add_node({.id = id, .T_map_node = step(static_cast<double>(id))});
    if (id > 0) {
      graph.add_edge(known_edge(id - 1, id, step(1.0)));
    }
  }
  return graph;
}

bool is_explained(const PoseGraph& graph, NodeId from, NodeId to,
                  const Eigen::Isometry3d& T_from_to, bool levelled = true) {
  const RelativeCovariances covariances(graph);
  RelativePoses relative(graph, covariances, Poses::measured, 4.0);
  return drift_explains(graph, relative,
                        {.from = from,
                         .to = to,
                         .T_from_to = T_from_to,
                         .covariance = test::diagonal_covariance(0.03, 0.003),
                         .levelled = levelled},
                        {});
}

// Along a line and along it again, tied over the first 8 m of it and drifting upwards after that.
TEST(ImpliedDrift, EndsWhereEarlierLoopsTieTheStretches) {
  PoseGraph graph = known_line(21);
  const NodeId again = 100;
  for (NodeId i = 0; i <= 20; ++i) {
    const auto x = static_cast<double>(i);
    const Eigen::Isometry3d pose = step(x) * up(0.05 * std::max(0.0, x - 8.0));
    graph.add_node({.id = again + i, .T_map_node = pose});
    const NodeId before = i == 0 ? 20 : again + i - 1;
    graph.add_edge(known_edge(before, again + i,
                              graph.nodes()[graph.index_of(before)].T_map_node.inverse() * pose));
  }
  EXPECT_TRUE(is_explained(graph, 8, again + 8, up(0.0)));
  EXPECT_FALSE(is_explained(graph, 8, again + 8, up(-12.0)));
  for (NodeId i = 0; i <= 8; ++i) {
    graph.add_edge(known_edge(i, again + i, up(0.0)));
  }
  EXPECT_TRUE(is_explained(graph, 12, again + 12, up(0.0))) << "0.2 m of drift since";
  EXPECT_FALSE(is_explained(graph, 9, again + 9, up(-2.0))) << "tied a metre before";
}

// The way between the stretches is 2 m long where they part, and 2 m longer with each keyframe.
TEST(ImpliedDrift, HoldsForEachPairOfALongStretch) {
  constexpr NodeId kLength = 300;
  PoseGraph graph = known_line(kLength);
  for (NodeId i = 0; i < kLength; ++i) {
    const NodeId id = 1000 + i;
    graph.add_node({.id = id, .T_map_node = step(static_cast<double>(i))});
    graph.add_edge(i == 0 ? known_edge(0, id, up(0.0)) : known_edge(id - 1, id, step(1.0)));
  }
  for (const NodeId i : {2, 40, 299}) {
    EXPECT_TRUE(is_explained(graph, i, 1000 + i, up(-0.5))) << "a step that was wrong";
    EXPECT_FALSE(is_explained(graph, i, 1000 + i, up(-1.5))) << i;
  }
}

// Loops have closed a round with much drift, and the optimum has had one edge take what all of them
// should: what is claimed a metre behind it is what was measured in that metre.
TEST(ImpliedDrift, IsOfWhatTheWayHasMeasuredWhereAnOptimumHasBentIt) {
  PoseGraph graph = known_line(21);
  const NodeId again = 100;
  for (NodeId i = 0; i <= 10; ++i) {
    const auto x = static_cast<double>(i);
    graph.add_node({.id = again + i, .T_map_node = step(x) * up(i > 4 ? 5.0 : 0.0)});
    graph.add_edge(i == 0 ? known_edge(20, again, step(-20.0))
                          : known_edge(again + i - 1, again + i, step(1)));
  }
  for (NodeId i = 0; i <= 3; ++i) {
    graph.add_edge(known_edge(i, again + i, up(0.0)));
  }
  EXPECT_TRUE(is_explained(graph, 5, again + 5, up(0.0)));
  EXPECT_FALSE(is_explained(graph, 5, again + 5, up(5.0))) << "where the graph has it";
}

TEST(ImpliedDrift, NothingExplainsATilt) {
  const PoseGraph graph = known_line(61);
  Eigen::Isometry3d claimed = step(60.0);
  EXPECT_TRUE(is_explained(graph, 0, 60, claimed));
  claimed.linear() *= Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_FALSE(is_explained(graph, 0, 60, claimed));
  EXPECT_TRUE(is_explained(graph, 0, 60, claimed, false))
      << "held otherwise, by somebody who does not know which way is up";
  claimed.linear() *= Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_FALSE(is_explained(graph, 0, 60, claimed, false));
}

TEST(ImpliedDrift, LoopsCorrectTheEdgesBetweenTheirEnds) {
  PoseGraph graph = known_line(11);
  graph.add_edge(known_edge(2, 6, step(4.0)));
  EXPECT_EQ(within_loops(graph), (std::vector<bool>{false, false, true, true, true, true, false,
                                                    false, false, false, false}));
}

}  // namespace
}  // namespace adit
