// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/imu_noise.hpp"

#include <algorithm>

namespace adit {

// White noise from the data sheets. These give bias stability rather than a random walk, so the
// walks are those that calibrations of such sensors usually find.
const std::vector<ImuPreset>& imu_presets() {
  static const std::vector<ImuPreset> presets = {
      // A mid-range MEMS sensor.
      {"generic", {.gyro = 2e-4, .accel = 2e-3, .gyro_walk = 6e-6, .accel_walk = 2e-4}},
      // Bosch BMI088: 0.014 deg/s/√Hz, 175 µg/√Hz.
      {"bmi088", {.gyro = 2.4e-4, .accel = 1.7e-3, .gyro_walk = 2e-5, .accel_walk = 3e-4}},
      // TDK ICM-20948, as in many lidars: 0.015 deg/s/√Hz, 230 µg/√Hz.
      {"icm20948", {.gyro = 2.6e-4, .accel = 2.3e-3, .gyro_walk = 2e-5, .accel_walk = 3e-4}},
      // Analog Devices ADIS16448: 0.0097 deg/s/√Hz, 200 µg/√Hz; walks as EuRoC states them.
      {"adis16448", {.gyro = 1.7e-4, .accel = 2.0e-3, .gyro_walk = 1.9e-5, .accel_walk = 3.0e-3}},
      // VectorNav VN-100: 0.0035 deg/s/√Hz, 140 µg/√Hz.
      {"vn100", {.gyro = 6.1e-5, .accel = 1.4e-3, .gyro_walk = 1e-5, .accel_walk = 1e-4}},
      // Xsens MTi-300 and similar: 0.01 deg/s/√Hz, 60 µg/√Hz.
      {"mti300", {.gyro = 1.7e-4, .accel = 5.9e-4, .gyro_walk = 1e-5, .accel_walk = 1e-4}},
  };
  return presets;
}

std::optional<ImuNoise> imu_preset(std::string_view name, double scale) {
  const auto found = std::ranges::find(imu_presets(), name, &ImuPreset::name);
  if (found == imu_presets().end()) {
    return std::nullopt;
  }
  const ImuNoise& noise = found->noise;
  return ImuNoise{.gyro = scale * noise.gyro,
                  .accel = scale * noise.accel,
                  .gyro_walk = scale * noise.gyro_walk,
                  .accel_walk = scale * noise.accel_walk};
}

}  // namespace adit
