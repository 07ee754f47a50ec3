// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/frame_tree.hpp"

#include <algorithm>
#include <cstddef>

namespace adit {
namespace {

/// tf's first version wrote names with a slash in front.
std::string plain(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

}  // namespace

void FrameTree::add(const StaticTransform& transform) {
  parents_[plain(transform.child)] = {plain(transform.parent), plain(transform.child),
                                      transform.T_parent_child};
}

bool FrameTree::knows(const std::string& frame) const {
  const std::string name = plain(frame);
  return parents_.contains(name) || std::ranges::any_of(parents_, [&](const auto& entry) {
           return entry.second.parent == name;
         });
}

std::optional<FrameTree::Mounting> FrameTree::mounting(const std::string& frame) const {
  Mounting result{plain(frame), Eigen::Isometry3d::Identity()};
  for (std::size_t steps = 0; steps <= parents_.size(); ++steps) {
    const auto found = parents_.find(result.root);
    if (found == parents_.end()) {
      return result;
    }
    result.T_root_frame = found->second.T_parent_child * result.T_root_frame;
    result.root = found->second.parent;
  }
  return std::nullopt;
}

std::optional<Eigen::Isometry3d> FrameTree::transform(const std::string& a,
                                                      const std::string& b) const {
  const std::optional<Mounting> first = mounting(a);
  const std::optional<Mounting> second = mounting(b);
  if (!first || !second || first->root != second->root) {
    return std::nullopt;
  }
  return first->T_root_frame.inverse() * second->T_root_frame;
}

}  // namespace adit
