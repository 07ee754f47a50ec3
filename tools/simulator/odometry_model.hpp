// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "adit/slam/core/types.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// Where the camera of a visual odometry sits in the IMU's frame: ahead of it and below the lidar.
Eigen::Isometry3d camera_mount();

/// Visual odometry with one camera, whose scale nothing measures: it is off by some per cent at
/// first, and drifts. Poses of the camera's frame (x ahead) in the frame that it started in.
class OdometrySimulator {
 public:
  /// The trajectory must outlive it. `rate` in Hz.
  OdometrySimulator(int rate, const SplineTrajectory& trajectory,
                    const Eigen::Isometry3d& T_imu_camera, uint64_t seed);

  /// The next pose; its stamp is counted from the start of the recording.
  ReferencePose next();

 private:
  int64_t period_;  ///< ns
  const SplineTrajectory* trajectory_;
  Eigen::Isometry3d T_imu_camera_;
  uint64_t seed_;
  double scale_;
  Eigen::Isometry3d T_start_camera_ = Eigen::Isometry3d::Identity();  ///< as it is estimated
  int64_t index_ = 0;
};

}  // namespace adit
