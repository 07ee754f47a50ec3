// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/imu_rest.hpp"

#include <cmath>

namespace adit {

ReadingStatistics statistics_of(std::span<const ImuSample> samples) {
  ReadingStatistics s;
  const auto n = static_cast<double>(samples.size());
  for (const ImuSample& sample : samples) {
    s.gyro += sample.angular_velocity / n;
    s.accel += sample.linear_acceleration / n;
  }
  for (const ImuSample& sample : samples) {
    s.gyro_deviation += (sample.angular_velocity - s.gyro).squaredNorm() / n;
    s.accel_deviation += (sample.linear_acceleration - s.accel).squaredNorm() / n;
  }
  s.gyro_deviation = std::sqrt(s.gyro_deviation);
  s.accel_deviation = std::sqrt(s.accel_deviation);
  return s;
}

bool is_quiet(const ReadingStatistics& readings) {
  return readings.gyro_deviation <= kRestGyro && readings.accel_deviation <= kRestAccel &&
         readings.gyro.norm() <= kRestGyroBias;
}

}  // namespace adit
