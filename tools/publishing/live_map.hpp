// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/mapping/map_store.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/tools/map_products/occupancy_grid.hpp"
#include "adit/tools/results/map_thinning.hpp"

namespace adit {

/// A keyframe where the map has it now.
struct LiveKeyframe {
  Nanoseconds stamp{0};
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();  ///< of its first sweep
};

/// What a call of LiveMap::read() has changed.
struct LiveMapChange {
  bool keyframes = false;  ///< there are more, or some lie elsewhere
  bool points = false;     ///< likewise of the cloud and the grid
};

/// The map of a run that goes on, read from its database beside the writer: where the keyframes
/// are, their points, thinned, and the cells that are occupied.
///
/// New keyframes are added. Where a keyframe has moved since it was added, by more than a cell of
/// the grid, as after a loop, cloud and grid are made anew. Where the cloud has a million points,
/// its voxels get twice as large.
class LiveMap {
 public:
  LiveMap();

  /// Reads what is new. `stop` is called between keyframes; after true, the rest is read by the
  /// next call. Throws InputError and OutputError where the database cannot be read.
  LiveMapChange read(const std::filesystem::path& map, const std::function<bool()>& stop);

  const std::vector<LiveKeyframe>& keyframes() const { return keyframes_; }
  /// Map frame, without intensity; one in each voxel.
  const std::vector<Point>& points() const { return points_; }
  const OccupancyGrid& grid() const { return grid_; }

 private:
  void add(const MapKeyframe& keyframe, const KeyframeSubmap& submap);
  bool has_moved(const MapKeyframe& keyframe) const;
  void begin_anew(double voxel);

  std::vector<LiveKeyframe> keyframes_;
  std::map<NodeId, Eigen::Isometry3d> T_keyframe_first_;  ///< see T_map_lidar
  std::map<NodeId, Eigen::Isometry3d> added_;             ///< T_map_keyframe when it was added
  std::vector<Point> points_;
  double voxel_;  ///< m
  MapThinning thinning_;
  OccupancyGrid grid_;
};

}  // namespace adit
