// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The data that enters the system. Frames and units: docs/conventions.md.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace adit {

/// Time since an epoch the recording chooses. Seconds appear only as differences.
using Nanoseconds = std::chrono::nanoseconds;

/// Time in seconds, for differences.
constexpr double seconds(Nanoseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

/// To the nearest of them. `seconds` within 292 years.
constexpr Nanoseconds nanoseconds(double seconds) {
  return std::chrono::round<Nanoseconds>(std::chrono::duration<double>(seconds));
}

/// One return in the lidar frame (m). `intensity` keeps the sensor's own scale; 0 where it has
/// none.
struct Point {
  float x = 0.0F;          ///< m
  float y = 0.0F;          ///< m
  float z = 0.0F;          ///< m
  float intensity = 0.0F;  ///< in the sensor's own unit
};
static_assert(sizeof(Point) == 16, "a Point is uploaded to the device as one vec4");

/// One turn of a range sensor, points in the lidar frame at the time each was captured.
/// Points may be NaN or (0, 0, 0): no return. `times`, `rings` and `doppler` are empty where the
/// source has none, and as long as `points` otherwise.
struct Sweep {
  Nanoseconds stamp{0};         ///< time of the start of the sweep
  std::vector<Point> points;    ///< lidar frame, m
  std::vector<float> times;     ///< s after `stamp`, one a point, or empty
  std::vector<uint16_t> rings;  ///< beam index, one a point, or empty
  /// How fast each point's distance from the sensor grows, m/s, or empty; NaN: not measured.
  std::vector<float> doppler{};
  std::string source;                   ///< file or message it came from, for messages to people
  std::optional<std::size_t> number{};  ///< among its recording's sweeps, from 0, where it is known
  /// m. Points + offset are the coordinates of the source. Not zero where these are so large that
  /// float32 would round them by more than half a millimetre.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

/// From a sweep's stamp to the last of its points' times, s; 0 without times.
inline double duration_of(const Sweep& sweep) {
  float last = 0.0F;
  for (const float time : sweep.times) {
    last = std::isfinite(time) ? std::max(last, time) : last;
  }
  return static_cast<double>(last);
}

/// Memory of a sweep's points with what is known of each, bytes.
inline std::size_t bytes_of(const Sweep& sweep) {
  return sweep.points.size() * sizeof(Point) + sweep.times.size() * sizeof(float) +
         sweep.rings.size() * sizeof(uint16_t) + sweep.doppler.size() * sizeof(float);
}

/// One reading of an inertial sensor, in the sensor's own axes. A sensor at rest with z up reads
/// +9.8 along z. What it does not measure is NaN.
struct ImuSample {
  Nanoseconds stamp{0};                                           ///< when it was measured
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();     ///< rad/s
  Eigen::Vector3d linear_acceleration = Eigen::Vector3d::Zero();  ///< m/s², gravity included
};

/// What a GNSS receiver says its fix rests on.
enum class GnssFixKind { none, single, satellite_augmented, ground_augmented };

/// A point on WGS 84.
struct Geodetic {
  double latitude = 0.0;   ///< degrees, north positive
  double longitude = 0.0;  ///< degrees, east positive
  double altitude = 0.0;   ///< m above the ellipsoid
};

/// One position of a GNSS antenna on WGS 84.
struct GnssFix {
  Nanoseconds stamp{0};                       ///< when it was measured
  GnssFixKind kind = GnssFixKind::none;       ///< how good it is
  double latitude = 0.0;                      ///< degrees, north positive
  double longitude = 0.0;                     ///< degrees, east positive
  double altitude = 0.0;                      ///< m above the ellipsoid
  std::optional<Eigen::Matrix3d> covariance;  ///< m², east north up; none: the receiver gives none
};

/// Velocity of a sensor that is fixed to the body, in the sensor's own axes: of wheels, of a radar,
/// of another odometry. An axis that is not measured is NaN.
struct BodyVelocity {
  Nanoseconds stamp{0};                              ///< when it was measured
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< m/s, sensor axes
  std::optional<Eigen::Matrix3d> covariance{};       ///< (m/s)²; none: the source gives none
  std::string frame{};  ///< whose velocity it is, and in whose axes; empty: the source names none
};

/// Which way the x axis of a sensor points in the level, measured against the Earth: two antennas,
/// a compass, an inertial system.
struct Heading {
  Nanoseconds stamp{0};           ///< when it was measured
  double yaw = 0.0;               ///< rad, counter-clockwise from true east
  std::optional<double> sigma{};  ///< rad; none: the source gives none
  std::string frame{};            ///< whose x axis it is; empty: the source names none
};

/// A bearing (rad, clockwise from north) as a yaw counter-clockwise from east, and back: within
/// half a turn of 0.
inline double yaw_of_bearing(double bearing) {
  return std::remainder(0.5 * std::numbers::pi - bearing, 2.0 * std::numbers::pi);
}

/// A pose that somebody else determined: T_parent_child maps child coordinates to the parent frame.
struct ReferencePose {
  Nanoseconds stamp{0};  ///< when it holds
  std::string parent;    ///< frame; empty where the source names none
  std::string child;     ///< frame that is placed
  Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();  ///< where it is
};

/// How two frames are mounted to each other.
struct StaticTransform {
  std::string parent;  ///< frame that the other is placed in
  std::string child;   ///< frame that is placed
  Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();  ///< where it is
  double quaternion_length = 1.0;  ///< of its rotation in the source, before it was normalised
};

/// A pose at a time: T_map_lidar maps lidar coordinates to the map frame.
struct StampedPose {
  Nanoseconds stamp{0};                                    ///< when it holds
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< T_map_lidar
};

}  // namespace adit
