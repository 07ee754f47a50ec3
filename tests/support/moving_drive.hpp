// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A lidar and an IMU carried along a street: each column of a sweep is measured where the sensor is
// at that time.
#pragma once

#include <numbers>
#include <vector>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/tests/support/simulated_imu.hpp"
#include "adit/tools/support/random.hpp"

namespace adit::test {

struct MovingDrive {
  std::vector<StampedPose> truth;  ///< T_world_lidar at each sweep's stamp
  std::vector<Sweep> sweeps;
  std::vector<ImuSample> readings;
};

/// Pose of the world's origin in which the motion's coordinates are: at the height of a head.
inline Eigen::Isometry3d start_of_street() {
  return Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 1.7));
}

/// Somebody who walks at `speed` m/s and swings the sensor about by `swing` rad in yaw.
inline WavyMotion walk(double speed, double swing) {
  return {.position = {{{0.03, 1.7, 0.0, speed}, {0.15, 0.4, 0.5, 0.0}, {0.03, 1.9, 1.0, 0.0}}},
          .angles = {{{0.03, 0.9, 0.2, 0.0}, {0.04, 1.1, 1.3, 0.0}, {swing, 0.8, 0.0, 0.0}}}};
}

inline Sweep scan_moving(const World& world, const WavyMotion& motion,
                         const Eigen::Isometry3d& T_body_lidar, const Lidar& lidar, double time) {
  constexpr double kTurn = 0.1;  // s
  Random random(static_cast<uint64_t>(1e6 * time) + 7U);
  Sweep sweep;
  sweep.stamp = at_seconds(time);
  sweep.source = "synthetic sweep";
  for (int column = 0; column < lidar.columns; ++column) {
    const double after = kTurn * column / lidar.columns;
    const Eigen::Isometry3d T_world_lidar =
        start_of_street() * motion.state(time + after).T_map_body * T_body_lidar;
    const double azimuth = 2.0 * std::numbers::pi * column / lidar.columns;
    for (int beam = 0; beam < lidar.beams; ++beam) {
      const double elevation =
          lidar.lowest + (lidar.highest - lidar.lowest) * beam / (lidar.beams - 1);
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const double distance =
          cast(world, T_world_lidar.translation(), T_world_lidar.linear() * direction);
      const double measured = distance + lidar.range_noise * random.gaussian();
      const Eigen::Vector3f p = (measured * direction).cast<float>();
      sweep.points.push_back(distance < lidar.max_range ? Point{p.x(), p.y(), p.z(), 0.5F}
                                                        : Point{});
      sweep.times.push_back(static_cast<float>(after));
    }
  }
  return sweep;
}

/// `sweeps` tenths of a second, and readings at 200 Hz with noise and biases.
inline MovingDrive moving_drive(const World& world, const WavyMotion& motion,
                                const Eigen::Isometry3d& T_body_lidar, const Lidar& lidar,
                                int sweeps) {
  constexpr double kReadingRate = 200.0;
  MovingDrive drive;
  for (int i = 0; i < sweeps; ++i) {
    const double time = 0.1 * i;
    drive.sweeps.push_back(scan_moving(world, motion, T_body_lidar, lidar, time));
    drive.truth.push_back(
        {at_seconds(time), start_of_street() * motion.state(time).T_map_body * T_body_lidar});
  }
  std::mt19937_64 engine(3);
  drive.readings = readings(motion, -0.1, 0.1 * sweeps + 0.1, kReadingRate,
                            {{0.01, -0.02, 0.015}, {0.05, 0.03, -0.04}});
  add_noise(drive.readings, {.gyro = 5e-4, .accel = 5e-3}, kReadingRate, engine);
  return drive;
}

}  // namespace adit::test
