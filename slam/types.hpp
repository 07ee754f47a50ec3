// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The data that enters the system. Frames and units: docs/conventions.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace adit {

/// Time since an epoch the recording chooses. Seconds appear only as differences.
using Nanoseconds = std::chrono::nanoseconds;

/// One return in the lidar frame (m). `intensity` keeps the sensor's own scale; 0 where it has
/// none.
struct Point {
  float x = 0.0F;
  float y = 0.0F;
  float z = 0.0F;
  float intensity = 0.0F;
};
static_assert(sizeof(Point) == 16, "a Point is uploaded to the device as one vec4");

/// One turn of a range sensor, points in the lidar frame at the time each was captured.
/// Points may be NaN or (0, 0, 0): no return. `times` and `rings` are empty where the source has
/// none, and as long as `points` otherwise.
struct Sweep {
  Nanoseconds stamp{0};         ///< time of the start of the sweep
  std::vector<Point> points;    ///< lidar frame, m
  std::vector<float> times;     ///< s after `stamp`, one a point, or empty
  std::vector<uint16_t> rings;  ///< beam index, one a point, or empty
  std::string source;           ///< file or message it came from, for messages to people
};

/// A pose at a time: T_map_lidar maps lidar coordinates to the map frame.
struct StampedPose {
  Nanoseconds stamp{0};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

}  // namespace adit
