// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The folder that `adit run` writes: trajectory.tum, trajectory.kitti, sweeps.csv, map.ply,
// map.html, summary.json; with a map also odometry.tum, online.tum and map.adit. Other files in it
// are left alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/mapping/mapper.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/results/localization_table.hpp"
#include "adit/tools/results/map_thinning.hpp"
#include "adit/tools/results/page_cloud.hpp"
#include "adit/tools/results/placed_cloud.hpp"
#include "adit/tools/results/sweep_table.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

struct MapOptions {
  bool enabled = true;
  std::optional<double>
      resolution;  ///< m, one point a voxel of this size; none: every keyframe point
};

/// The paths of a run's files.
struct RunFiles {
  explicit RunFiles(const std::filesystem::path& folder);

  std::filesystem::path tum;
  std::filesystem::path kitti;
  std::filesystem::path sweeps;
  std::filesystem::path map;
  std::filesystem::path page;
  std::filesystem::path odometry;  ///< beside a map database: what it does not correct
  std::filesystem::path online;    ///< poses in the map as they were known at their time
  std::filesystem::path database;
  std::filesystem::path localization;  ///< of a run in an earlier map
  std::filesystem::path summary;
};

/// Where it is not there. Throws OutputError.
void make_output_folder(const std::filesystem::path& folder);

/// Makes the folder and makes sure that each file in it can be written, and the `others`, without
/// touching what an earlier run left there. Throws OutputError naming the file.
void check_writable(const std::filesystem::path& folder, const MapOptions& map,
                    const std::vector<std::filesystem::path>& others = {});

/// Writes trajectories, table and map as the sweeps come. What is written of a sweep is with the
/// operating system before the next sweep: it survives the end of the process, whatever ends it.
class RunOutputs {
 public:
  /// Empties trajectories and table and, where there is to be one, the map. Throws OutputError.
  /// `odometry`: odometry.tum, too, for a run whose map corrects the trajectory.
  RunOutputs(const std::filesystem::path& folder, const MapOptions& map, bool odometry = false);

  /// Sweep `index` of the recording; `mapped` is where a map sees it, which the trajectories
  /// follow. Throws OutputError (a full disk); what earlier sweeps wrote stays as it was.
  void write(const SweepResult& sweep, std::size_t index,
             const std::optional<MapPlacement>& mapped = std::nullopt);

  /// Closes every file, then throws OutputError if one of them could not be completed. Cuts
  /// half-written lines off.
  void close();

  /// Keyframes' clouds, thinned, for a page; empty without a map.
  const PageCloud& page_cloud() const { return page_cloud_; }
  /// Memory grows with the map, for the voxels that its points are thinned by.
  bool thins() const { return thinning_.has_value(); }
  uint64_t map_points() const { return map_ ? map_->count() : 0; }
  /// What map.ply is made of, with the poses of the odometry; empty without one.
  const std::vector<CloudPart>& map_parts() const { return map_parts_; }

 private:
  void write_map(const SweepResult& keyframe);

  RunFiles files_;
  std::optional<TrajectoryWriter> tum_;
  std::optional<TrajectoryWriter> kitti_;
  std::optional<TrajectoryWriter> odometry_;
  std::optional<SweepTableWriter> sweeps_;
  std::optional<LocalizationTableWriter> localization_;  ///< once a sweep has one
  std::optional<PlyWriter> map_;
  std::optional<MapThinning> thinning_;
  std::vector<CloudPart> map_parts_;
  PageCloud page_cloud_;
  uint32_t poses_ = 0;         ///< written
  std::vector<Point> points_;  ///< points of the current keyframe, map frame
};

}  // namespace adit
