// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <thread>

#include "adit/tools/dds/dds_node.hpp"
#include "adit/tools/publishing/live_map.hpp"

namespace adit {

/// Publishes the map of a run to ROS 2 as it grows and as loops correct it, latched:
///
/// - /adit/path (nav_msgs/Path): the keyframes where they are now, at most once a second;
/// - /adit/map (sensor_msgs/PointCloud2): their points, thinned, at most every five seconds;
/// - /adit/occupancy_grid (nav_msgs/OccupancyGrid): cells within 100 m of the last keyframe, with
///   the cloud.
///
/// A thread of its own reads the database, a tenth of the time at most.
class MapPublisher {
 public:
  /// `node` outlives it. Throws std::runtime_error.
  MapPublisher(DdsNode& node, std::string map_frame);
  ~MapPublisher() { end(); }
  MapPublisher(const MapPublisher&) = delete;
  MapPublisher& operator=(const MapPublisher&) = delete;

  /// The map that is published from now on. `T_lidar_base`: how the base is mounted.
  void begin(const std::filesystem::path& map, const Eigen::Isometry3d& T_lidar_base);
  /// The map is read no more. What it has by now is published before.
  void end();

 private:
  void follow(const std::filesystem::path& map, const std::stop_token& stop);
  void publish_path(const LiveMap& map);
  void publish_points(const LiveMap& map);
  void publish_grid(const LiveMap& map);

  DdsNode& node_;
  std::string frame_;
  std::size_t path_topic_;
  std::size_t map_topic_;
  std::size_t grid_topic_;
  Eigen::Isometry3d T_lidar_base_ = Eigen::Isometry3d::Identity();
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace adit
