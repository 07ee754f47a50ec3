// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// The first part of a map is the one that lies in the world.
class FirstPart {
 public:
  explicit FirstPart(const PoseGraph& graph)
      : graph_(&graph), component_of_(connected_components(graph).component_of) {}
  bool has(NodeId node) const { return component_of_[graph_->index_of(node)] == 0; }

 private:
  const PoseGraph* graph_;
  std::vector<std::size_t> component_of_;
};

}  // namespace adit
