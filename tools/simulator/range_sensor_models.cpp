// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Angles and times from the manufacturers' manuals: VLP-16 (63-9243), HDL-32E (63-9113), HDL-64E S2
// (appendix G), Ouster's OS0 and OS1, Livox's Mid-360 and Avia. What a manual leaves open is said
// where it is chosen.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <numbers>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/range_sensor.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// Rings count from the lowest beam up.
void number_rings(std::vector<LaserChannel>& channels) {
  for (LaserChannel& channel : channels) {
    channel.ring = static_cast<uint16_t>(std::ranges::count_if(
        channels, [&](const LaserChannel& other) { return other.elevation < channel.elevation; }));
  }
}

RangeSensor vlp16() {
  SpinningPattern pattern{.channels = {}, .cycle = 55296};
  for (int laser = 0; laser < 16; ++laser) {
    // Even lasers go up from -15 degrees, odd ones from 1 degree, by 2 degrees. Those that look
    // down sit above those that look up.
    const double elevation = laser % 2 == 0 ? -15.0 + laser : laser;
    pattern.channels.push_back(
        {.elevation = elevation * kDegree, .height = -0.000747 * elevation, .time = laser * 2304});
  }
  number_rings(pattern.channels);
  return {.name = "VLP-16", .pattern = pattern, .range_at_tenth = 50.0, .noise = 0.02};
}

RangeSensor hdl32e() {
  SpinningPattern pattern{.channels = {}, .cycle = 46080};
  for (int laser = 0; laser < 32; ++laser) {
    const int step = laser % 2 == 0 ? laser / 2 - 23 : laser / 2 - 7;
    pattern.channels.push_back({.elevation = step * 4.0 / 3.0 * kDegree, .time = laser * 1152});
  }
  number_rings(pattern.channels);
  return {.name = "HDL-32E", .pattern = pattern, .range_at_tenth = 50.0, .noise = 0.02};
}

/// Nominal angles: each unit is calibrated. A laser of the upper and one of the lower block fire at
/// once, 728 ns before the next two; the mean cycle is that of 1.333 million points a second. The
/// manual's bursts of six cycles between packets are spread evenly.
RangeSensor hdl64e() {
  SpinningPattern pattern{.channels = {}, .cycle = 48000};
  for (int i = 0; i < 32; ++i) {
    pattern.channels.push_back({.elevation = (-8.83 - 0.5 * i) * kDegree,
                                .azimuth = (i % 2 == 0 ? 3.0 : -3.0) * kDegree,
                                .time = i * 728});
    pattern.channels.push_back({.elevation = (2.0 - i / 3.0) * kDegree,
                                .azimuth = (i % 2 == 0 ? 3.0 : -3.0) * kDegree,
                                .height = 0.08,
                                .time = i * 728});
  }
  number_rings(pattern.channels);
  return {.name = "HDL-64E",
          .pattern = pattern,
          .nearest = 0.9,
          .farthest = 120.0,
          .range_at_tenth = 50.0,
          .noise = 0.02,
          .divergence = 0.001};
}

/// All beams of a column share its time; each of four neighbours is turned a little differently.
/// Nominal angles: each unit has its own in its metadata.
struct OusterModel {
  const char* name;
  int beams;
  double half_field;      ///< degrees
  double stagger;         ///< degrees between the outermost and the middle
  double origin_radius;   ///< m, of the beams' origin before the axis
  double range_at_tenth;  ///< m
  double divergence;      ///< rad
};
constexpr std::array<OusterModel, 3> kOusters{{{"OS1-64", 64, 22.5, 3.164, 0.0158, 45.0, 0.0016},
                                               {"OS1-128", 128, 22.5, 4.23, 0.0158, 45.0, 0.0016},
                                               {"OS0-128", 128, 45.0, 11.0, 0.0277, 15.0, 0.0031}}};

RangeSensor ouster(const OusterModel& model) {
  constexpr int64_t kColumns = 1024;
  SpinningPattern pattern{.channels = {}, .cycles_per_sweep = kColumns, .start = std::numbers::pi};
  for (int beam = model.beams - 1; beam >= 0; --beam) {
    const double share = static_cast<double>(beam) / (model.beams - 1);
    const int place = (model.beams - 1 - beam) % 4;
    pattern.channels.push_back({.elevation = model.half_field * (2.0 * share - 1.0) * kDegree,
                                .azimuth = model.stagger * (1.0 - 2.0 / 3.0 * place) * kDegree,
                                .radius = model.origin_radius,
                                .ring = static_cast<uint16_t>(model.beams - 1 - beam)});
  }
  return {.name = model.name,
          .layout = CloudLayout::ouster,
          .pattern = pattern,
          .nearest = 0.3,
          .farthest = 120.0,
          .range_at_tenth = model.range_at_tenth,
          .noise = 0.015,
          .resolution = 0.001,
          .divergence = model.divergence,
          .intensity_scale = 255.0};
}

/// 200 000 points a second over 360 x 59 degrees. The manual shows the pattern but does not define
/// it: here four lasers go up and down while the mirror turns, at frequencies without a common
/// period.
RangeSensor mid360() {
  return {.name = "Mid-360",
          .layout = CloudLayout::livox,
          .pattern = TracedPattern{.curve = TracedPattern::Curve::zigzag,
                                   .lines = 4,
                                   .interval = 20000,
                                   .frequencies = {11.7082, 536.871},
                                   .low = {0.0, -7.0 * kDegree},
                                   .high = {2.0 * std::numbers::pi, 52.0 * kDegree}},
          .nearest = 0.1,
          .farthest = 70.0,
          .range_at_tenth = 40.0,
          .noise = 0.02,
          .resolution = 0.001,
          .divergence = 0.0025,
          .intensity_scale = 255.0};
}

/// 240 000 points a second over 70.4 x 77.2 degrees: the rosette of two prisms that turn against
/// each other, six lasers side by side. The manual gives field and rate; the prisms' speeds are
/// those published for the family.
RangeSensor avia() {
  return {.name = "Avia",
          .layout = CloudLayout::livox,
          .pattern = TracedPattern{.curve = TracedPattern::Curve::rosette,
                                   .lines = 6,
                                   .interval = 25000,
                                   .frequencies = {7294.0 / 60.0, -4664.0 / 60.0},
                                   .low = {-35.2 * kDegree, -38.6 * kDegree},
                                   .high = {35.2 * kDegree, 38.6 * kDegree},
                                   .line_spacing = 0.8 * kDegree},
          .nearest = 1.0,
          .farthest = 450.0,
          .range_at_tenth = 190.0,
          .noise = 0.02,
          .resolution = 0.001,
          .divergence = 0.0012,
          .intensity_scale = 255.0};
}

/// An active stereo camera of the size of RealSense's D435: 87 x 58 degrees, a base of 50 mm,
/// pixels matched to 0.08 of one, so that depths scatter with their square.
RangeSensor depth_camera() {
  constexpr int kWidth = 424;
  constexpr double kFocal = 223.4;    // px: 87 degrees across
  constexpr double kBase = 0.05;      // m
  constexpr double kMatching = 0.08;  // px
  return {.name = "depth-camera",
          .layout = CloudLayout::camera,
          .pattern = CameraPattern{.width = kWidth, .height = 240, .focal = kFocal},
          .nearest = 0.2,
          .farthest = 10.0,
          .range_at_tenth = 10.0,
          .noise = 0.001,
          .noise_growth = kMatching / (2.0 * kFocal * kBase),
          .resolution = 0.001,
          .divergence = 0.002,
          .intensity_scale = 255.0};
}

std::vector<RangeSensor> sensors() {
  std::vector<RangeSensor> all{vlp16(), hdl32e(), hdl64e()};
  for (const OusterModel& model : kOusters) {
    all.push_back(ouster(model));
  }
  all.push_back(mid360());
  all.push_back(avia());
  all.push_back(depth_camera());
  return all;
}

}  // namespace

std::vector<std::string> range_sensor_names() {
  std::vector<std::string> names;
  for (const RangeSensor& sensor : sensors()) {
    names.push_back(sensor.name);
  }
  return names;
}

RangeSensor range_sensor_named(std::string_view name) {
  for (RangeSensor& sensor : sensors()) {
    if (sensor.name == name) {
      return std::move(sensor);
    }
  }
  throw UsageError("there is no sensor '" + std::string(name) + "'. " +
                   suggestion(std::string(name), range_sensor_names()) + ".");
}

}  // namespace adit
