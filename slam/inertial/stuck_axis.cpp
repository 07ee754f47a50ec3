// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/stuck_axis.hpp"

#include <algorithm>
#include <cmath>

#include "adit/slam/core/nav_state.hpp"

namespace adit {
namespace {

constexpr double kShortest = 0.5;  // s
constexpr int kFewest = 50;        // readings
constexpr int kAlive = 10;         // changes of an axis that works
constexpr double kTurning = 0.1;   // rad/s
constexpr double kMoving = 0.5;    // in the accelerometer's unit
constexpr double kSteps = 10.0;    // of others, while an axis makes none

std::optional<StuckAxis> of_accelerometer(std::optional<StuckAxis> found) {
  if (found) {
    found->gyroscope = false;
  }
  return found;
}

}  // namespace

void StuckAxisWatch::add(Triad& triad, const Eigen::Vector3d& value, Nanoseconds stamp) {
  for (int i = 0; i < 3; ++i) {
    Axis& axis = triad[static_cast<size_t>(i)];
    if (axis.readings == 0 || value(i) != axis.value) {
      const double step = axis.readings == 0 ? axis.least_step : std::abs(value(i) - axis.value);
      axis = {.value = value(i),
              .since = stamp,
              .readings = 1,
              .changes = axis.changes + (axis.readings == 0 ? 0 : 1),
              .least_step = std::min(axis.least_step, step),
              .least = value,
              .greatest = value};
      continue;
    }
    ++axis.readings;
    axis.least = axis.least.cwiseMin(value);
    axis.greatest = axis.greatest.cwiseMax(value);
  }
}

void StuckAxisWatch::add(const ImuSample& sample) {
  add(gyroscope_, sample.angular_velocity, sample.stamp);
  add(accelerometer_, sample.linear_acceleration, sample.stamp);
  last_ = sample.stamp;
}

std::optional<StuckAxis> StuckAxisWatch::stuck(const Triad& triad, const Bounds& bounds,
                                               Nanoseconds now) {
  for (int i = 0; i < 3; ++i) {
    const Axis& axis = triad[static_cast<size_t>(i)];
    const double duration = seconds(now - axis.since);
    const double moved = (axis.greatest - axis.least).maxCoeff();
    if (axis.changes >= kAlive && axis.readings >= kFewest && duration >= kShortest &&
        axis.since <= bounds.latest && moved > bounds.least &&
        moved > bounds.steps * axis.least_step) {
      return StuckAxis{.axis = i, .value = axis.value, .duration = duration};
    }
  }
  return std::nullopt;
}

std::optional<StuckAxis> StuckAxisWatch::stuck() const {
  const auto gyroscope = stuck(gyroscope_, {.least = kTurning}, last_);
  return gyroscope ? gyroscope : of_accelerometer(stuck(accelerometer_, {.least = kMoving}, last_));
}

std::optional<StuckAxis> StuckAxisWatch::unchanged(Nanoseconds latest) const {
  const Bounds bounds{.steps = kSteps, .latest = latest};
  const auto gyroscope = stuck(gyroscope_, bounds, last_);
  return gyroscope ? gyroscope : of_accelerometer(stuck(accelerometer_, bounds, last_));
}

}  // namespace adit
