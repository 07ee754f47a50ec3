// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "adit/slam/fusion/high_rate_stream.hpp"
#include "adit/tools/dds/dds_node.hpp"
#include "adit/tools/publishing/duration_sample.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The inertial readings of a run that goes on.
struct PublishedMotion {
  const Recording* recording = nullptr;  ///< outlives the session
  std::size_t topic = 0;                 ///< of the readings
  ImuConfig config{};
  /// When an event arrived, by what the recording notes.
  std::function<std::chrono::system_clock::time_point(Nanoseconds received)> arrival{};
  std::string odom_frame{};
  std::string base_frame{};
  Eigen::Isometry3d T_lidar_base = Eigen::Isometry3d::Identity();
};

/// Publishes /adit/odometry_high_rate (nav_msgs/Odometry): the base at the time of each inertial
/// reading, the newest fused sweep carried on.
///
/// A thread of its own reads the readings as they arrive, so that they wait neither for a sweep
/// that is being aligned nor for the map.
class MotionPublisher {
 public:
  /// `node` outlives it. Throws std::runtime_error.
  explicit MotionPublisher(DdsNode& node);
  ~MotionPublisher() { end(); }
  MotionPublisher(const MotionPublisher&) = delete;
  MotionPublisher& operator=(const MotionPublisher&) = delete;

  /// A session begins; reading begins with the first sweep that was fused.
  void begin(PublishedMotion source);
  /// The odometry has placed a sweep.
  void update(const InertialReport& report);
  /// The session ends. It waits for a reading, or for the end of the recording.
  void end();

  /// Of each pose, from the arrival of its reading until it was published.
  DurationSample ages() const;

 private:
  void follow(const std::stop_token& stop);
  void publish(const LidarMotion& motion);

  DdsNode& node_;
  std::size_t topic_;
  PublishedMotion source_;
  mutable std::mutex mutex_;  ///< of the stream and the ages
  std::optional<HighRateStream> stream_;
  DurationSample ages_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace adit
