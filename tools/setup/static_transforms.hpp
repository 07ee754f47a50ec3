// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adit/slam/core/frame_tree.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// How the frames of a recording are mounted to each other.
struct RecordedTransforms {
  /// In their order; those of `constant` last.
  std::vector<StaticTransform> transforms{};
  /// Of topics for moving frames (/tf), without which the sensors' frames would not be connected.
  std::vector<StaticTransform> constant{};
  std::vector<std::string> damage{};  ///< of messages of static transforms, a sentence each
};

/// The static transforms of a recording: those of its first seconds and, where these do not connect
/// `frames` (of sensors, the first with the others), those of the rest. Where they still do not,
/// transforms that stay constant on /tf for its first 20 s. Damage is passed over.
RecordedTransforms recorded_transforms(const Recording& recording,
                                       const std::vector<std::string>& frames);

/// The frames as a run connects them.
FrameTree frame_tree_of(const RecordedTransforms& transforms);

/// Why a run ignores a transform: "the transform from 'a' to 'a' leads from a frame to itself".
std::string describe(const IgnoredTransform& ignored);
/// "'base' to 'imu', 'base' to 'lidar' and 2 more".
std::string names_of(const std::vector<StaticTransform>& transforms);
/// Two mountings that contradict each other; `frames` are for people.
std::string describe(const MountingConflict& conflict, const std::string& frames);

/// What is odd about the transforms and how a run handles it, a sentence each.
std::vector<std::string> notes_of(const RecordedTransforms& transforms);

/// Published with a quaternion that is not of length 1, by more than rounding explains (tf2's
/// bound).
bool is_scaled(const StaticTransform& transform);

}  // namespace adit
