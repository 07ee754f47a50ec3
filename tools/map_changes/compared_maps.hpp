// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The sessions that `adit changes` compares, in one frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_merge/tied_maps.hpp"

namespace adit {

/// A session that is compared.
struct ComparedSession {
  SessionId id = 0;  ///< in its map
  std::string name{};
  std::filesystem::path map{};
  /// Its place in the order of time. Of two maps, all sessions of the first come before all of the
  /// second.
  uint32_t period = 0;
  Nanoseconds first{0};  ///< stamps of its first and its last keyframe
  Nanoseconds last{0};
  std::size_t keyframes = 0;
};

struct ComparedKeyframe {
  std::size_t map = 0;  ///< in ComparedMaps::maps
  NodeId id = 0;        ///< in that map
  uint32_t period = 0;
  /// Keyframes of one part are tied to each other; how parts lie to each other is a guess.
  std::size_t part = 0;
  Eigen::Isometry3d T_common_keyframe = Eigen::Isometry3d::Identity();
  Eigen::AlignedBox3d seen{};  ///< around what it saw and where from, common frame, m
};

/// Where a keyframe of the first map is in the common frame, and in that map.
struct FrameTie {
  Eigen::Isometry3d T_common_keyframe = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_map_keyframe = Eigen::Isometry3d::Identity();
};

struct ComparedMaps {
  std::vector<std::unique_ptr<MapDatabase>> maps{};
  std::vector<ComparedSession> sessions{};     ///< in the order of time
  std::vector<ComparedKeyframe> keyframes{};   ///< the same
  double r_submap = 0.0;                       ///< m, the largest edge of submaps' cells
  std::optional<Georeference> georeference{};  ///< of the first map
  std::vector<FrameTie> ties{};                ///< empty: the common frame is the map's

  /// Of a place of the common frame: around it, this maps the common frame to the first map's.
  Eigen::Isometry3d T_map_common(const Eigen::Vector3d& place) const;
};

/// A map with several sessions, or two maps, which are tied to each other first. The maps stay as
/// they are. Throws UsageError (no map or more than two), InputError (not readable, one session
/// alone, no sessions that are tied to each other), LockedError, MergeStopped and what the device
/// throws.
ComparedMaps compared_maps(const std::vector<std::filesystem::path>& maps,
                           const DeviceOptions& device,
                           const std::function<bool(const MergeStep&)>& on_step);

}  // namespace adit
