// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Do the sweeps and the gyroscope of a recording tell the same motion? A stretch of the sweeps is
// mapped, and its rotations are compared with the gyroscope's.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/core/frame_tree.hpp"
#include "adit/slam/inertial/rotation_comparison.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/tools/inspection/recording_findings.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/results/sweep_table.hpp"

namespace adit {

/// Sweeps, an IMU and where to look at them.
struct MotionPair {
  Topic sweeps;
  std::size_t sweep_topic = 0;
  Topic imu;
  std::size_t imu_topic = 0;
  TimeSpan stretch{};             ///< by the recorder's clock
  bool trust_point_times = true;  ///< to tell when, on average, a sweep was taken
  /// R_range_gyro by the configuration or the recording's static transforms, where they tell it.
  std::optional<Eigen::Matrix3d> R_range_gyro;
  std::string told_by = "/tf_static";  ///< for people: what tells it
};

/// How both sensors turned between two sweeps, rad, axes of the range sensor.
struct ComparedTurn {
  double end = 0.0;       ///< s after the first sweep of the stretch
  double duration = 0.0;  ///< s
  Eigen::Vector3d range = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyroscope = Eigen::Vector3d::Zero();  ///< at the offset found, without its bias
};

struct MotionCheck {
  MotionPair pair;
  std::size_t sweeps = 0;   ///< number in the stretch
  std::size_t tracked = 0;  ///< number aligned with those before
  double period = 0.0;      ///< s from sweep to sweep, the median
  bool point_times = false;
  /// Nothing where the motion does not tell. Whole seconds between the clocks are left out of the
  /// offset: they are derived from the recorder's clock.
  std::optional<RotationComparison> comparison;
  std::vector<SweepRecord> mapped{};  ///< the sweeps of the stretch, aligned without an IMU
  std::vector<ComparedTurn> turns{};  ///< where there is a comparison
};

/// Reads the stretch twice, sweeps first. `place` is Odometry::step. Damaged places are passed
/// over: who reads all of the recording reports them.
MotionCheck check_motion(const Recording& recording, const MotionPair& pair,
                         const std::function<SweepResult(const Sweep&)>& place);

/// Clocks that are apart by more than the sweeps can hide, and a mounting that the motion
/// contradicts.
std::vector<Finding> find_in_motion(const MotionCheck& check);

/// One line for people: offset, mounting, and how sure; or why they cannot be told.
std::string describe(const MotionCheck& check);

}  // namespace adit
