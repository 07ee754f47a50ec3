// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Pose graphs in g2o's text format:
//   VERTEX_SE3:QUAT id x y z qx qy qz qw
//   EDGE_SE3:QUAT from to x y z qx qy qz qw  and the 21 upper entries of the information, row by
//   row VERTEX_SE2 id x y yaw EDGE_SE2 from to x y yaw  and the 6 upper entries FIX id ...
// m and rad; blank lines and what follows a '#' are skipped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

struct G2oFile {
  PoseGraph graph;
  std::vector<uint64_t> edge_lines;  ///< where each edge of the graph stands, from 1
  /// Edges whose information had negative eigenvalues, which count as zero: public graphs have
  /// such.
  std::vector<uint64_t> indefinite_lines;
  std::size_t parameter_lines = 0;  ///< PARAMS_...: sensor offsets, which no edge read here uses
};

/// Edges between nodes whose ids follow each other are odometry, all others loops; they may come
/// before their vertices. Throws InputError with the line: an unknown tag, a wrong number of
/// columns, what is no finite number, SE(3) and SE(2) mixed, a node given twice or missing, an edge
/// from a node to itself; and where there is no vertex.
G2oFile read_g2o(const std::filesystem::path& file);

/// The same from memory; `file` is for messages.
G2oFile parse_g2o(std::string_view text, const std::filesystem::path& file);

/// Numbers read back to the same doubles, but for those that quaternions are rounded to. Of a map's
/// verticals and fixes a comment in the first line tells how many are left out. Throws OutputError.
void write_g2o(const std::filesystem::path& file, const PoseGraph& graph);

}  // namespace adit
