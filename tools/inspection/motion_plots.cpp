// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/motion_plots.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/tools/drawing/time_panels.hpp"

namespace adit {
namespace {

constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};

/// One curve an axis; `vector(i)` at the i-th of `count` times.
template <class Vector>
std::vector<Curve> axes_of(std::size_t count, Vector&& vector) {
  std::vector<Curve> curves;
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    Curve curve{.name = std::string(kNames[k]), .color = kAxisColors[k], .values = {}};
    for (std::size_t i = 0; i < count; ++i) {
      curve.values.push_back(vector(i)[static_cast<Eigen::Index>(k)]);
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

/// The stretch that each bin is in; null: in motion.
std::vector<const RestStretch*> rest_of(const ImuTimeline& timeline,
                                        const std::vector<RestStretch>& stretches) {
  std::vector<const RestStretch*> at_rest(timeline.bins().size(), nullptr);
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    const double middle = timeline.bin_width() * (static_cast<double>(i) + 0.5);
    for (const RestStretch& one : stretches) {
      at_rest[i] = middle > one.begin && middle < one.end ? &one : at_rest[i];
    }
  }
  return at_rest;
}

TimePanel rest_panel(const ImuTimeline& timeline, const std::vector<const RestStretch*>& at_rest) {
  TimePanel panel{.title = "At rest, or moving evenly, as far as the readings tell",
                  .bands = {{.name = "IMU", .values = {}}},
                  .classes = {{"at rest", kGoodColor}, {"in motion", kUnknownColor}}};
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    const bool known = timeline.bins()[i].turns > 0.0;
    panel.bands[0].values.push_back(!known ? -1 : at_rest[i] != nullptr ? 0 : 1);
  }
  return panel;
}

/// Angles of up off z, towards x and y.
TimePanel up_panel(const ImuTimeline& timeline, const std::optional<Eigen::Matrix3d>& R_range_imu) {
  const Eigen::Matrix3d R = R_range_imu.value_or(Eigen::Matrix3d::Identity());
  Curve x{.name = "towards x", .color = kAxisColors[0], .values = {}};
  Curve y{.name = "towards y", .color = kAxisColors[1], .values = {}};
  for (const ImuBin& bin : timeline.bins()) {
    const Eigen::Vector3d up = R * bin.acceleration();
    x.values.push_back(kDegreesPerRadian * std::atan2(up.x(), up.z()));
    y.values.push_back(kDegreesPerRadian * std::atan2(up.y(), up.z()));
  }
  return {.title = std::string("Up by the accelerometer, off the z of the ") +
                   (R_range_imu ? "range sensor" : "IMU") + " (degrees)",
          .curves = {std::move(x), std::move(y)}};
}

}  // namespace

std::string draw_imu(const ImuStatistics& imu, const std::optional<Eigen::Matrix3d>& R_range_imu,
                     double width) {
  const std::vector<ImuBin>& bins = imu.timeline.bins();
  const std::vector<RestStretch> stretches = rest_stretches(imu.timeline);
  const std::vector<const RestStretch*> at_rest = rest_of(imu.timeline, stretches);
  std::vector<double> times;
  Curve acceleration{.name = "", .values = {}};
  for (const ImuBin& bin : bins) {
    times.push_back(imu.timeline.bin_width() * (static_cast<double>(times.size()) + 0.5));
    acceleration.values.push_back(bin.acceleration().norm());
  }
  const std::vector<TimePanel> panels = {
      rest_panel(imu.timeline, at_rest),
      {.title = "Angular velocity (rad/s, axes of the IMU)",
       .curves = axes_of(bins.size(), [&](std::size_t i) { return bins[i].rotation(); })},
      {.title = "Angular velocity at rest: the gyroscope's bias (mrad/s, axes of the IMU)",
       .curves = axes_of(bins.size(),
                         [&](std::size_t i) {
                           return at_rest[i] == nullptr
                                      ? kUnknownVector
                                      : Eigen::Vector3d(1e3 * at_rest[i]->gyro_bias);
                         })},
      {.title =
           "Acceleration as the sensor has it (norm of the mean; m/s^2 if it keeps to SI units)",
       .curves = {std::move(acceleration)},
       .gates = {{"gravity", kStandardGravity}}},
      up_panel(imu.timeline, R_range_imu)};
  return draw_time_panels(times, panels, width, "time since the first reading (s)");
}

std::string draw_turns(const MotionCheck& check, double width) {
  const std::vector<ComparedTurn>& turns = check.turns;
  std::vector<double> times;
  for (const ComparedTurn& turn : turns) {
    times.push_back(turn.end);
  }
  const auto of = [&](double unit, auto&& value) {
    return axes_of(turns.size(), [&turns, unit, value](std::size_t i) -> Eigen::Vector3d {
      return unit * value(turns[i]);
    });
  };
  const std::vector<TimePanel> panels = {
      {.title = "Turned by the sweeps (mrad a sweep, axes of the range sensor)",
       .curves = of(1e3, [](const ComparedTurn& t) -> Eigen::Vector3d { return t.range; })},
      {.title = "Turned by the gyroscope, without its bias, at the offset found (mrad a sweep)",
       .curves = of(1e3, [](const ComparedTurn& t) -> Eigen::Vector3d { return t.gyroscope; })},
      {.title = "Their difference (mrad a sweep)",
       .curves = of(
           1e3, [](const ComparedTurn& t) -> Eigen::Vector3d { return t.gyroscope - t.range; })}};
  return draw_time_panels(times, panels, width, "time since the first sweep of the stretch (s)");
}

}  // namespace adit
