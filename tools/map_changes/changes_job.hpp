// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What has changed between the sessions of a map, or from one map to another (docs/maps.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "adit/slam/core/upright_box.hpp"
#include "adit/tools/map_changes/changed_space.hpp"

namespace adit {

struct ChangesCommandOptions {
  std::vector<std::filesystem::path> maps{};  ///< one or two: files, or folders of runs
  std::filesystem::path output{};             ///< GeoJSON; empty: none
  DeviceOptions device{};                     ///< two maps are tied to each other on it
  bool quiet = false;
  bool json = false;
};

/// Voxels that touch each other and changed alike.
struct ChangedObject {
  ChangeOfSpace change = ChangeOfSpace::gone;
  /// Periods: the last one that has it and the first one that sees through it; of one that appeared
  /// the first that has it, and the last that saw through its place.
  uint32_t period = 0;
  uint32_t other = 0;
  UprightBox box{};        ///< around its points, map frame
  std::size_t points = 0;  ///< of submaps
  std::size_t voxels = 0;
  uint32_t through = 0;               ///< submaps that see through it: the median voxel's
  std::optional<Geodetic> place{};    ///< of its centre, where the map is georeferenced
  std::vector<Geodetic> footprint{};  ///< the same of its box's corners, at its bottom
};

struct ChangesOutcome {
  std::vector<ComparedSession> sessions{};  ///< in the order of time
  std::vector<ChangedObject> objects{};     ///< the largest first
  double voxel = 0.0;                       ///< m, edge
  std::size_t points = 0;                   ///< that were compared
  bool georeferenced = false;
};

/// Compares, and writes the output where there is one. The maps are only read. False from `on_step`
/// ends it with MergeStopped. Throws as compared_maps() does, and OutputError.
ChangesOutcome changes_job(const ChangesCommandOptions& options,
                           const std::function<bool(const ChangesStep&)>& on_step);

}  // namespace adit
