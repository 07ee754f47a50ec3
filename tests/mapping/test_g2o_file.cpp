// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/g2o_file.hpp"

#include <string>

#include <gtest/gtest.h>

#include "adit/benchmarks/simulated_graph.hpp"
#include "adit/slam/graph/solver.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

const std::string kInformation =
    " 4 0 0 0 0 0 4 0 0 0 0 4 0 0 0 9 0 0 9 0 9";  // upper half, row by row

/// Two nodes and an edge, then more lines.
std::string se3(const std::string& more = {}) {
  return "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\r\n"
         "# a remark\n"
         "VERTEX_SE3:QUAT 7 1 2 3 0 0 0.7071067811865476 0.7071067811865476\n"
         "EDGE_SE3:QUAT 0 7 1 2 3 0 0 0 1" +
         kInformation + "\n" + more;
}

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(parse_g2o(text, "graph.g2o"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(G2oFile, ReadsNodesEdgesAndWhatIsFixed) {
  const G2oFile file = parse_g2o(se3("FIX 7\nPARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n"), "graph.g2o");
  ASSERT_EQ(file.graph.nodes().size(), 2U);
  EXPECT_TRUE(file.graph.nodes()[1].fixed);
  EXPECT_NEAR(file.graph.nodes()[1].T_map_node.linear()(1, 0), 1.0, 1e-15);
  ASSERT_EQ(file.graph.edges().size(), 1U);
  EXPECT_EQ(file.edge_lines, std::vector<uint64_t>{4});
  EXPECT_EQ(file.graph.edges()[0].information(2, 2), 4.0);
  EXPECT_EQ(file.graph.edges()[0].information(5, 5), 9.0);
  EXPECT_EQ(file.graph.edges()[0].kind, EdgeKind::loop);
  EXPECT_EQ(file.parameter_lines, 1U);
}

TEST(G2oFile, ReadsGraphsOfThePlaneWithEdgesBeforeTheirNodes) {
  const G2oFile file = parse_g2o(
      "EDGE_SE2 3 2 -1 0.5 0.25 10 1 2 20 3 30\nVERTEX_SE2 3 1 0 0.5\nVERTEX_SE2 2 0 0 0\n", "p");
  EXPECT_TRUE(file.graph.planar());
  EXPECT_EQ(file.graph.nodes()[0].id, 2);
  const PoseEdge& edge = file.graph.edges()[0];
  EXPECT_EQ(edge.kind, EdgeKind::odometry);
  EXPECT_EQ(edge.information(0, 5), 2.0);
  EXPECT_EQ(edge.information(5, 1), 3.0);
  EXPECT_EQ(edge.information(5, 5), 30.0);
  EXPECT_EQ(edge.information(2, 2), 0.0);
}

TEST(G2oFile, NamesTheLineAndWhatIsWrongThere) {
  const std::pair<std::string, std::string> cases[] = {
      {"VERTEX_SE3:QUAT 8 0 0 0 0 0 0\n", "line 5: words after VERTEX_SE3:QUAT: 7, expected 8"},
      {"VERTEX_SE3:QUAT 8 0 nan 0 0 0 0 1\n", "line 5: 'nan' is not a number of at most 1e9"},
      {"VERTEX_SE3:QUAT 8 0 1e300 0 0 0 0 1\n", "line 5: '1e300' is not a number"},
      {"VERTEX_SE3:QUAT 8 0 0 0 0 0 0 0\n", "line 5: the quaternion"},
      {"VERTEX_SE3:QUAT -8 0 0 0 0 0 0 1\n", "line 5: the id '-8'"},
      {"VERTEX_SE3:QUAT 99999999999999999999 0 0 0 0 0 0 1\n", "line 5: the id"},
      {"VERTEX_SE3:QUAT 7 0 0 0 0 0 0 1\n", "line 5: node 7 is there already"},
      {"EDGE_SE3:QUAT 0 9 1 2 3 0 0 0 1" + kInformation + "\n",
       "line 5: the edge from 0 to 9 names node 9, which does not exist"},
      {"EDGE_SE3:QUAT 7 7 1 2 3 0 0 0 1" + kInformation + "\n",
       "line 5: the edge from 7 to 7 ties"},
      {"VERTEX_SE2 9 0 0 0\n", "line 5: SE(2) and SE(3) in one file"},
      {"VERTEX_SE3 9 0 0 0\n", "nearest valid name is 'VERTEX_SE2'"},
      {"VERTEX_XY 9 0 0\n", "line 5: the tag 'VERTEX_XY' is none that is read"},
      {"FIX 9\n", "line 5: there is no node 9"},
      {"FIX\n", "line 5: FIX names 0 nodes"},
      {"EDGE_SE3:QUAT 0 7 1 2 3 0 0 0 1 4 0", "line 5: words after EDGE_SE3:QUAT: 11, expected 30"},
  };
  for (const auto& [line, message] : cases) {
    EXPECT_NE(error_of(se3(line)).find("graph.g2o, "), std::string::npos) << line;
    EXPECT_NE(error_of(se3(line)).find(message), std::string::npos)
        << line << " gave: " << error_of(se3(line));
  }
  EXPECT_NE(error_of("\n# nothing\n").find("it holds no vertex"), std::string::npos);
}

TEST(G2oFile, NegativeEigenvaluesCountAsZeroAndTheirLinesAreTold) {
  const G2oFile file = parse_g2o(
      se3("EDGE_SE3:QUAT 0 7 1 2 3 0 0 0 1 -1" + kInformation.substr(2) + "\n"), "graph.g2o");
  EXPECT_EQ(file.indefinite_lines, std::vector<uint64_t>{5});
  EXPECT_NEAR(file.graph.edges()[1].information(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(file.graph.edges()[1].information(1, 1), 4.0, 1e-12);
  EXPECT_EQ(file.graph.edges()[0].information(0, 0), 4.0);
}

TEST(G2oFile, IsReadBackAsItWasWritten) {
  const test::TemporaryFolder folder;
  for (const bool planar : {false, true}) {
    SimulatedGraph simulated =
        simulated_graph({.nodes = 300, .loops = 20, .seed = 1, .planar = planar});
    simulated.graph.set_fixed(12, true);
    const auto path = folder.path() / (planar ? "plane.g2o" : "space.g2o");
    write_g2o(path, simulated.graph);
    const PoseGraph again = read_g2o(path).graph;
    ASSERT_EQ(again.nodes().size(), simulated.graph.nodes().size());
    EXPECT_TRUE(again.nodes()[12].fixed);
    for (std::size_t i = 0; i < again.nodes().size(); ++i) {
      EXPECT_LT(
          (again.nodes()[i].T_map_node.matrix() - simulated.graph.nodes()[i].T_map_node.matrix())
              .cwiseAbs()
              .maxCoeff(),
          1e-14);
    }
    for (std::size_t i = 0; i < again.edges().size(); ++i) {
      EXPECT_EQ(again.edges()[i].information, simulated.graph.edges()[i].information);
      EXPECT_EQ(again.edges()[i].kind, simulated.graph.edges()[i].kind);
    }
    const double cost = graph_cost(simulated.graph, {});
    EXPECT_GT(cost, 1.0);
    EXPECT_NEAR(graph_cost(again, {}), cost, 1e-6 * cost);
  }
}

/// Bytes of a graph with some changed, cut or doubled.
std::string damaged(std::string text, Random& random) {
  const auto place = [&] {
    return static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(text.size())));
  };
  const std::string alphabet = "0123456789-+.eEnaif \n\t#:_VX";
  for (int i = 0; i < 4; ++i) {
    const double what = random.uniform(0.0, 4.0);
    const auto letter = alphabet[static_cast<std::size_t>(
        random.uniform(0.0, static_cast<double>(alphabet.size())))];
    if (what < 2.0) {
      text[place()] = letter;
    } else if (what < 3.0) {
      text.insert(place(), 1, letter);
    } else {
      text.erase(place(), 3);
    }
  }
  return random.uniform(0.0, 1.0) < 0.2 ? text.substr(0, place()) : text;
}

// Whatever stands in a file: a graph that can be optimised, or an error that names its line.
TEST(G2oFile, DamagedFilesAreReadOrRefusedAndNeverEndTheProgram) {
  Random random(1);
  int read = 0;
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string text = damaged(se3("FIX 0\n"), random);
    try {
      const G2oFile file = parse_g2o(text, "graph.g2o");
      ++read;
      if (i % 10 == 0) {
        const OptimizedGraph result = optimize(file.graph, {.max_iterations = 5});
        EXPECT_EQ(result.poses.size(), file.graph.nodes().size());
      }
    } catch (const InputError& error) {
      ++refused;
      EXPECT_TRUE(error.place().starts_with("line ") || error.place().empty()) << error.what();
    }
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace adit
