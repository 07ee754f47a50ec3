// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/core/frame_tree.hpp"
#include "adit/slam/executor/slam.hpp"
#include "adit/tools/dds/dds_node.hpp"

namespace adit {

/// Names of the frames that are published.
struct RosFrames {
  std::string map = "map";
  std::string odom = "odom";
  std::string base{};  ///< empty: the lidar's
};

/// Publishes a run to ROS 2, sweep by sweep:
///
/// - /adit/odometry (nav_msgs/Odometry, reliable): the base in `odom`, which is smooth, with the
///   covariance of the pose and the velocity since the sweep before;
/// - /tf: `map` to `odom`, which jumps where a loop closes, and `odom` to the base;
/// - /adit/keyframe_cloud (sensor_msgs/PointCloud2): each keyframe's points in `map`;
/// - /diagnostics (diagnostic_msgs/DiagnosticArray): once a second of the sensor's time, whether
///   sweeps are aligned.
class TopicPublisher {
 public:
  /// `node` outlives it. Throws std::runtime_error.
  TopicPublisher(DdsNode& node, RosFrames frames);

  /// A session begins. How the base is mounted on the lidar, by static transforms. Throws
  /// InputError where a base is named and they do not connect it with the lidar.
  void begin(const FrameTree& transforms, const std::string& lidar_frame);
  const RosFrames& frames() const { return frames_; }
  const Eigen::Isometry3d& T_lidar_base() const { return T_lidar_base_; }

  /// The odometry has placed the sweep.
  void publish(const Sweep& sweep, const SweepResult& result);
  /// The map has it.
  void publish(const SweepPlaced& placed);

 private:
  void publish_odometry(const SweepResult& result, const Eigen::Isometry3d& T_odom_base);
  void publish_transforms(Nanoseconds stamp, const Eigen::Isometry3d& T_odom_base);
  void publish_diagnostics(const SweepResult& result);
  void publish_cloud(const SweepResult& result, const Eigen::Isometry3d& T_map_lidar);

  DdsNode& node_;
  RosFrames wanted_;
  RosFrames frames_;  ///< with the base that is used
  std::size_t odometry_topic_;
  std::size_t transforms_topic_;
  std::size_t cloud_topic_;
  std::size_t diagnostics_topic_;
  Eigen::Isometry3d T_lidar_base_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_map_odom_ = Eigen::Isometry3d::Identity();
  std::optional<UncertainPose> last_{};  ///< of the base in `odom`
  std::optional<Nanoseconds> diagnosed_{};
  std::size_t sweeps_ = 0;
  std::size_t unaligned_ = 0;
};

}  // namespace adit
