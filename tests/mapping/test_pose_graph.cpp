// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/pose_graph.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tests/support/error_text.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;

PoseGraph graph_of(const std::vector<NodeId>& ids, bool planar = false) {
  PoseGraph graph(planar);
  for (const NodeId id : ids) {
    graph.add_node({.id = id, .T_map_node = step(static_cast<double>(id))});
  }
  return graph;
}

TEST(PoseGraph, KeepsNodesInOrderAndEdgesWithThemHoweverTheyCome) {
  PoseGraph graph = graph_of({5, 9});
  graph.add_edge(edge(5, 9, step(4.0)));
  graph.add_node({.id = 7});
  graph.add_node({.id = 1});
  graph.add_edge(edge(7, 5, step(-2.0)));
  EXPECT_EQ(graph.index_of(1), 0U);
  EXPECT_EQ(graph.index_of(9), 3U);
  EXPECT_EQ(graph.edges_of(5).size(), 2U);
  EXPECT_EQ(graph.edges_of(9).front(), 0U);
  EXPECT_EQ(graph.edges_of(7).front(), 1U);
  EXPECT_TRUE(graph.edges_of(1).empty());
  EXPECT_FALSE(graph.contains(6));
}

TEST(PoseGraph, SaysWhatIsWrongWithANode) {
  PoseGraph graph = graph_of({1, 2});
  EXPECT_EQ(test::error_of<GraphError>([&] { graph.add_node({.id = 1}); }),
            "node 1 is there already");
  PoseNode broken{.id = 3};
  broken.T_map_node.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(test::error_of<GraphError>([&] { graph.add_node(broken); }),
            "the pose of node 3 is not finite");
  broken.T_map_node = step(1.0);
  broken.T_map_node.linear() *= 1.1;
  EXPECT_EQ(test::error_of<GraphError>([&] { graph.add_node(broken); }),
            "the pose of node 3 holds no rotation");
  PoseGraph plane(true);
  PoseNode above{.id = 1};
  above.T_map_node.translation().z() = 0.1;
  EXPECT_NE(test::error_of<GraphError>([&] { plane.add_node(above); }).find("not in the plane"),
            std::string::npos);
  EXPECT_EQ(test::error_of<GraphError>([&] { graph.index_of(8); }), "there is no node 8");
}

TEST(PoseGraph, SaysWhatIsWrongWithAnEdge) {
  PoseGraph graph = graph_of({1, 2});
  const auto error_with = [&](const PoseEdge& wrong) {
    return test::error_of<GraphError>([&] { graph.add_edge(wrong); });
  };
  EXPECT_EQ(error_with(edge(1, 4, step(1.0))),
            "the edge from 1 to 4 names node 4, which does not exist");
  EXPECT_EQ(error_with(edge(2, 2, step(1.0))), "the edge from 2 to 2 ties a node to itself");
  PoseEdge wrong = edge(1, 2, step(1.0));
  wrong.information(0, 1) = 3.0;
  EXPECT_EQ(error_with(wrong), "the information of the edge from 1 to 2 is not symmetric");
  wrong.information(1, 0) = 3.0;
  EXPECT_EQ(error_with(wrong), "no error");
  wrong.information(4, 4) = -2.0;
  EXPECT_NE(error_with(wrong).find("negative eigenvalue (-2.0"), std::string::npos);
  wrong.information(4, 4) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error_with(wrong), "the information of the edge from 1 to 2 is not finite");
  wrong.information.setZero();
  EXPECT_EQ(error_with(wrong), "no error") << "an edge may know nothing";
}

TEST(PoseGraph, ComponentsAreTiedByActiveEdges) {
  PoseGraph graph = graph_of({1, 2, 3, 4, 5, 6});
  graph.add_edge(edge(1, 3, step(2.0)));
  graph.add_edge(edge(6, 4, step(-2.0)));
  graph.add_edge(edge(1, 6, step(5.0)));
  graph.set_status(2, EdgeStatus::revoked);
  graph.set_fixed(6, true);
  const GraphComponents found = connected_components(graph);
  ASSERT_EQ(found.components.size(), 4U);
  EXPECT_EQ(found.component_of, (std::vector<std::size_t>{0, 1, 0, 2, 3, 2}));
  EXPECT_EQ(found.components[2].first, 4);
  EXPECT_EQ(found.components[2].nodes, 2U);
  EXPECT_EQ(found.components[2].edges, 1U);
  EXPECT_EQ(nodes_to_hold(found), (std::vector<NodeId>{1, 2, 5}));
}

}  // namespace
}  // namespace adit
