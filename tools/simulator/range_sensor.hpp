// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Range sensors by name: where each pulse goes, when, and what comes back of it. Frame: lidar,
// x ahead, y left, z up.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace adit {

/// One laser of a spinning sensor.
struct LaserChannel {
  double elevation = 0.0;  ///< rad
  double azimuth = 0.0;    ///< rad, counter-clockwise from the rotor's direction
  double height = 0.0;     ///< m, of its origin over the sensor's
  double radius = 0.0;     ///< m, of its origin before the axis
  int64_t time = 0;        ///< ns after the cycle's start
  uint16_t ring = 0;       ///< as its driver numbers it
};

/// All lasers fire once a cycle while the head turns clockwise, seen from above.
struct SpinningPattern {
  std::vector<LaserChannel> channels;  ///< in the order of firing
  int64_t cycles_per_sweep = 0;        ///< 0: cycles go on across sweeps, `cycle` apart
  int64_t cycle = 0;                   ///< ns; unused where cycles_per_sweep is set
  double start = 0.0;                  ///< rad, azimuth at the start of a sweep
};

/// Livox's sensors draw curves that do not close. `lines` lasers fire at once.
struct TracedPattern {
  enum class Curve { zigzag, rosette };
  Curve curve = Curve::zigzag;
  int lines = 4;
  int64_t interval = 20000;           ///< ns between firings
  Eigen::Vector2d frequencies{0, 0};  ///< Hz: around and up and down; of the two prisms
  Eigen::Vector2d low{0, 0};          ///< rad, azimuth and elevation
  Eigen::Vector2d high{0, 0};
  double line_spacing = 0.0;  ///< rad between lines (rosette)
};

/// A depth camera: all pixels at once, row by row from the upper left, without distortion.
struct CameraPattern {
  int width = 0;       ///< px
  int height = 0;      ///< px
  double focal = 0.0;  ///< px
};

/// How a driver lays out its clouds.
enum class CloudLayout {
  velodyne,  ///< x y z intensity, ring uint16, time float32: s after the stamp; returns alone
  ouster,    ///< organised, (0, 0, 0) without a return; t uint32: ns after the stamp
  hesai,     ///< ring uint16, timestamp float64: s of the epoch
  livox,     ///< Livox's CustomMsg
  camera,    ///< organised as the picture, x y z intensity, NaN without a return
};
std::string_view to_string(CloudLayout layout);

/// velodyne, ouster, hesai, livox: layouts that any sensor's cloud can have. Throws UsageError for
/// other names, with the nearest.
CloudLayout cloud_layout_named(std::string_view name);

struct RangeSensor {
  std::string name;
  CloudLayout layout = CloudLayout::velodyne;
  std::variant<SpinningPattern, TracedPattern, CameraPattern> pattern;
  int64_t period = 100000000;      ///< ns a sweep
  double nearest = 0.5;            ///< m
  double farthest = 100.0;         ///< m
  double range_at_tenth = 60.0;    ///< m at which a surface of reflectivity 0.1 is just detected
  double noise = 0.02;             ///< m, standard deviation of a range
  double noise_growth = 0.0;       ///< 1/m, times the squared range: more of it, of stereo
  double resolution = 0.002;       ///< m, ranges come in multiples of it
  double divergence = 0.0015;      ///< rad, half angle of the beam
  double intensity_scale = 100.0;  ///< intensity of a white surface seen straight on
  bool doppler = false;            ///< measures the radial speed of each return
};

/// One pulse.
struct Firing {
  int64_t time = 0;  ///< ns after the start of the sweep
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit length
  uint16_t ring = 0;
};

/// The pulses of sweep `index` (counted from the start of the recording), in the order of time.
std::vector<Firing> firings_of(const RangeSensor& sensor, int64_t index);

std::vector<std::string> range_sensor_names();

/// VLP-16, HDL-32E, HDL-64E, OS1-64, OS1-128, OS0-128, Mid-360, Avia, depth-camera; at 10 Hz.
/// Throws UsageError for other names, with the nearest.
RangeSensor range_sensor_named(std::string_view name);

}  // namespace adit
