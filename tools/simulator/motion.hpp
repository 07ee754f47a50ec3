// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How a sensor is carried along a scene's route.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// A way of moving, as people and vehicles do.
struct MotionStyle {
  std::string_view name;
  double height = 1.5;       ///< m of the sensor above the floor
  double speed_scale = 1.0;  ///< factor on the scene's speed
  double speed = 0.0;        ///< m/s, instead of the scene's; 0: that
  double step = 0.0;         ///< m between footfalls; 0: on wheels
  double bounce = 0.025;     ///< m, up and down with each step
  double swing = 0.0;        ///< rad, how far the sensor is turned to the sides by hand
  double pace = 1.0;         ///< how fast it is turned
  double rest = 1.0;         ///< s at rest before the start
  bool stops = false;        ///< stands still for a while now and then
};

std::vector<std::string> motion_names();

/// drive, walk, handheld (turned at up to 2 rad/s), fast-handheld (run with, at 3 m/s, 15 m/s² and
/// 4 rad/s), stop-and-go, moving-start (at full speed from
/// the first moment). Throws UsageError for other names, with the nearest.
MotionStyle motion_named(std::string_view name);

/// The motion of the body (the IMU: x ahead, z up) along the scene's route, from `begin` metres
/// behind its first corner on and round again where the time suffices. `duration` and what it needs
/// beyond in s; `speed` in m/s where it is not the scene's. Throws UsageError where the way has no
/// direction.
SplineTrajectory make_trajectory(const Scene& scene, const MotionStyle& style, double duration,
                                 std::optional<double> speed = std::nullopt, double begin = 0.0,
                                 const Checkpoint& checkpoint = {});

/// Length of the scene's route once round (m).
double route_length(const Scene& scene);

}  // namespace adit
