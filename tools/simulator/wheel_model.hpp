// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "adit/slam/core/types.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// What wheels measure, and what they should have.
struct SimulatedWheels {
  BodyVelocity velocity{};  ///< stamp counted from the start of the recording
  Nanoseconds received{0};  ///< likewise: the end of the period that was counted
  Eigen::Vector3d truth =
      Eigen::Vector3d::Zero();  ///< m/s, axes of the wheels' frame, at the stamp
  double scale = 1.0;           ///< measured distance over the true one
};

/// Where the frame of the wheels sits in the IMU's unless something else is asked for: below and to
/// the left, x ahead.
Eigen::Isometry3d wheel_mount();

/// Encoders of wheels that roll along the x axis of their frame. They count ticks, so that a speed
/// is a number of ticks in a period, stamped with its middle. The radius of the tyres is not known
/// to a per cent. The speeds to the side and up are not measured: they are reported as zero, with
/// the standard deviation that they have where the ground is uneven.
class WheelSimulator {
 public:
  /// The trajectory must outlive it. `rate` in Hz.
  WheelSimulator(int rate, const SplineTrajectory& trajectory,
                 const Eigen::Isometry3d& T_imu_wheels, uint64_t seed);

  SimulatedWheels next();

 private:
  int64_t period_;  ///< ns
  const SplineTrajectory* trajectory_;
  Eigen::Isometry3d T_imu_wheels_;
  uint64_t seed_;
  double scale_;
  double distance_ = 0.0;  ///< m, as the wheels roll
  double counted_ = 0.0;   ///< m, in whole ticks
  int64_t index_ = 0;
};

}  // namespace adit
