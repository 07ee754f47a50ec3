// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// Why a FrameTree does not use a transform.
enum class TransformFault {
  itself,      ///< it leads from a frame to itself
  unnamed,     ///< one of its frames has no name
  not_finite,  ///< its pose is not finite, or no rigid motion
  loop,        ///< with it a frame would be its own ancestor, at another place
};

/// A transform that a FrameTree was given and does not use.
struct IgnoredTransform {
  std::string parent;                             ///< its frames, as they were given
  std::string child;                              ///< see parent
  TransformFault fault = TransformFault::itself;  ///< why

  /// Whether all members are equal.
  bool operator==(const IgnoredTransform&) const = default;
};

/// Two chains of transforms that mount the same frames differently.
struct MountingConflict {
  std::string parent;     ///< of a transform of the chain that is not used
  std::string child;      ///< see parent
  double distance = 0.0;  ///< m between both mountings
  double angle = 0.0;     ///< rad between both mountings
};

/// How the frames of a robot are mounted to each other, by its static transforms.
///
/// A later transform of the same two frames replaces an earlier one, as in tf2. A frame may have
/// several parents. The relative pose of two frames follows from the shortest chain of transforms
/// between them; among equally short ones the later parent counts. A transform that cannot be part
/// of a tree is ignored, and the others stay. Frames are compared without leading slashes, which
/// tf's first version wrote.
class FrameTree {
 public:
  /// Takes a transform, unless it is to be ignored. Memory is bounded: beyond 2000 transforms of
  /// different frames nothing is added.
  void add(const StaticTransform& transform);

  /// Nothing was added.
  bool empty() const { return entries_.empty(); }
  /// Some transform names the frame.
  bool knows(const std::string& frame) const;

  /// A frame in its topmost ancestor.
  struct Mounting {
    std::string root;  ///< the topmost ancestor; the frame itself where it has no parent
    Eigen::Isometry3d T_root_frame =
        Eigen::Isometry3d::Identity();  ///< maps the frame's coordinates to the root's
  };
  /// By each frame's latest parent.
  Mounting mounting(const std::string& frame) const;

  /// T_a_b; nothing where no chain of transforms connects the frames.
  std::optional<Eigen::Isometry3d> transform(const std::string& a, const std::string& b) const;

  /// The chain that contradicts transform(a, b) most, by more than 1 cm or 0.5 degrees; nothing
  /// where all agree.
  std::optional<MountingConflict> conflict(const std::string& a, const std::string& b) const;

  /// Each once, in the order in which they were added.
  const std::vector<IgnoredTransform>& ignored() const { return ignored_; }

 private:
  struct Entry {
    StaticTransform transform;  ///< names without leading slashes
    bool loop = false;          ///< it closes a loop: the last choice
    bool replaced = false;      ///< by a later one of the same frames
  };
  /// Indices of entries, from one frame to another.
  using Chain = std::vector<std::size_t>;

  void ignore(const StaticTransform& transform, TransformFault fault);
  void make_latest_parent(std::size_t entry);
  bool is_ancestor(const std::string& frame, const std::string& of) const;
  Chain chain_to_root(const std::string& frame) const;
  std::optional<Chain> chain_by_parents(const std::string& a, const std::string& b) const;
  std::optional<Chain> shortest_chain(const std::string& a, const std::string& b,
                                      std::optional<std::size_t> without) const;
  Eigen::Isometry3d product(const std::string& a, const Chain& chain) const;

  std::vector<Entry> entries_;                                            // as they were added
  std::map<std::pair<std::string, std::string>, std::size_t> of_frames_;  // the latest of each pair
  std::map<std::string, std::vector<std::size_t>> parents_;  // entries by child, the latest last
  std::vector<IgnoredTransform> ignored_;
};

}  // namespace adit
