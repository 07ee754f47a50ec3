// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Public pose graphs with known minima: chi squared, not halved, under each of the three
// conventions. Of torus3D and cubicle the smallest values that are known.
#include <algorithm>
#include <array>
#include <string>

#include <gtest/gtest.h>

#include "adit/slam/graph/initialization.hpp"
#include "adit/slam/graph/solver.hpp"
#include "adit/tests/support/shared_data.hpp"
#include "adit/tools/map_products/g2o_file.hpp"

namespace adit {
namespace {

struct PublicGraph {
  std::string name;
  std::array<double, 3> minima;  ///< (t, q_vec), (t, Log R), Log
  bool certain = true;           ///< the minima; else no more than these
  bool chordal = false;          ///< where to start from
  double rounding = 0.0;         ///< rounding of the published value's last digit
};

class PublicGraphs : public testing::TestWithParam<PublicGraph> {};

TEST_P(PublicGraphs, EndAtTheKnownMinimum) {
  ADIT_SHARED_DATA_OR_SKIP(file, "pose_graphs/" + GetParam().name + ".g2o");
  PoseGraph graph = read_g2o(file).graph;
  if (GetParam().chordal) {
    graph.set_poses(chordal_poses(graph));
  }
  for (const int i : {0, 1, 2}) {
    const double known = GetParam().minima[static_cast<std::size_t>(i)];
    const OptimizedGraph result =
        optimize(graph, {.convention = static_cast<ResidualConvention>(i)});
    EXPECT_EQ(result.report.termination, Termination::converged);
    EXPECT_LT(result.report.cost_after, known + 1e-6 * known + GetParam().rounding) << i;
    if (GetParam().certain) {
      EXPECT_GT(result.report.cost_after, known - 1e-6 * known - GetParam().rounding) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    KnownMinima, PublicGraphs,
    testing::Values(PublicGraph{"smallGrid3D", {458.154, 1033.894, 1035.851}, true, false, 5e-4},
                    PublicGraph{"sphere2500", {727.1497, 1351.362, 1351.402}, true, false, 5e-4},
                    PublicGraph{
                        "parking-garage", {1.238691, 1.268384, 1.268385}, true, false, 5e-7},
                    PublicGraph{"torus3D", {14574.746, 24233.019, 24235.274}, false, true, 5e-4},
                    PublicGraph{"cubicle", {5946.67, 11465.6, 11483.7}, false, true, 0.05}),
    [](const auto& test) {
      std::string name = test.param.name;
      std::ranges::replace(name, '-', '_');
      return name;
    });

}  // namespace
}  // namespace adit
