// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace adit {

/// Continuous noise densities of an inertial sensor. The default is a mid-range MEMS sensor on a
/// vehicle or in a hand: about five times what its data sheet says of it on a table.
struct ImuNoise {
  double gyro = 1e-3;        ///< rad/s/√Hz, white
  double accel = 1e-2;       ///< m/s²/√Hz, white
  double gyro_walk = 3e-5;   ///< rad/s²/√Hz, of the bias
  double accel_walk = 1e-3;  ///< m/s³/√Hz, of the bias
  /// Share of what is measured: errors of scale, and axes that are not square.
  double scale = 0.0;
};

/// A sensor by name with the densities of its manufacturer.
struct ImuPreset {
  std::string_view name;  ///< as imu.sensor names it
  ImuNoise noise;         ///< its densities
};

/// Sensors that are often built into or onto range sensors.
const std::vector<ImuPreset>& imu_presets();

/// The manufacturer's densities times `scale`; none: there is no such preset. Data sheets speak of
/// a sensor on a table; on vehicles and in hands 5 to 10 times as much is usual.
std::optional<ImuNoise> imu_preset(std::string_view name, double scale);

}  // namespace adit
