// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Submaps keep no intensity. The cloud that a run leaves beside its map does, of some of its
// sweeps: a map's points get that of the place they lie at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <unordered_map>
#include <vector>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/viewer/view_graph.hpp"

namespace adit {

class SeenIntensity {
 public:
  /// Knows nothing.
  SeenIntensity();
  /// By `map.ply` and `trajectory.tum` in the folder of a run, if its `summary.json` has that many
  /// points; else it knows nothing. A file that is damaged is told to `progress`. `sweeps` are
  /// those of `keyframes`.
  static SeenIntensity of(const std::filesystem::path& folder,
                          const std::vector<MapKeyframe>& keyframes,
                          const std::vector<ViewSweep>& sweeps, std::ostream& progress);

  /// The intensity (TilePointFacts) of a point of that keyframe, by its position, that lies at
  /// `p_map` (m) now. Nothing where the run saw nothing, or left no sweep of the keyframe: it is of
  /// another run.
  std::optional<uint8_t> at(std::size_t keyframe, const Eigen::Vector3d& p_map) const;

 private:
  /// A cube of space, by its number along each axis.
  using Key = uint64_t;
  struct Cell {
    float sum = 0.0F;
    uint32_t count = 0;
  };

  void read(const std::filesystem::path& cloud);
  void coarsen();

  double edge_;  ///< m, of a cell
  float brightest_ = 0.0F;
  std::unordered_map<Key, Cell> cells_;
  /// Of each keyframe: from where its points are now to where they were when the cloud was written.
  std::vector<std::optional<Eigen::Isometry3d>> T_cloud_map_;
};

}  // namespace adit
