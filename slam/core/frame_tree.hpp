// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "adit/slam/core/types.hpp"

namespace adit {

/// How the frames of a robot are mounted to each other, as its static transforms tell.
class FrameTree {
 public:
  /// A frame has one parent: the last one reported counts.
  void add(const StaticTransform& transform);

  /// Nothing was reported.
  bool empty() const { return parents_.empty(); }
  /// Some transform names the frame.
  bool knows(const std::string& frame) const;

  /// A frame in its topmost ancestor; a loop of frames has none.
  struct Mounting {
    std::string root;  ///< the topmost ancestor
    Eigen::Isometry3d T_root_frame =
        Eigen::Isometry3d::Identity();  ///< maps the frame's coordinates to the root's
  };
  /// Of a frame that was reported; else nothing.
  std::optional<Mounting> mounting(const std::string& frame) const;

  /// T_a_b; nothing where the frames do not hang together.
  std::optional<Eigen::Isometry3d> transform(const std::string& a, const std::string& b) const;

 private:
  std::map<std::string, StaticTransform> parents_;  // by child
};

}  // namespace adit
