// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/vertical.hpp"

namespace adit {

std::optional<LevelledNode> level_of(NodeId node, Vertical vertical) {
  constexpr double kGravity = 0.02;  // rad
  return vertical == Vertical::gravity
             ? std::optional(LevelledNode{.node = node, .information = 1.0 / (kGravity * kGravity)})
             : std::nullopt;
}

}  // namespace adit
