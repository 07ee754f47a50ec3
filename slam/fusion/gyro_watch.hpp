// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/fusion/inertial_event.hpp"
#include "adit/slam/inertial/gyro_monitor.hpp"

namespace adit {

/// How an inertial sensor is taken to be on the lidar, and in time.
struct SensorFrame {
  Eigen::Isometry3d T_body_lidar = Eigen::Isometry3d::Identity();
  double clock_offset = 0.0;  ///< s, its stamps are later by this much
};

/// A sensor that is corrected: how, and what it is taken for from now on.
struct FrameCorrection {
  SensorCorrected what;
  SensorFrame frame;
};

/// What follows from holding a gyroscope against the sweeps.
using GyroVerdict = std::variant<FrameCorrection, GyroscopeDisagrees>;

/// What may be corrected of a frame, and how far it must be off.
struct CorrectionBounds {
  bool clock = false;
  bool mounting = false;
  double least_clock = 0.0;  ///< s; less stays as it is
  double sigmas = 0.0;       ///< what is within so many standard deviations stays as it is
};

/// The correction that a comparison asks for, which the check must have; none if nothing is to be.
std::optional<FrameCorrection> correction(const GyroCheck& check, const SensorFrame& frame,
                                          const CorrectionBounds& bounds);

/// Holds the gyroscope against the sweeps, says what follows where they contradict it, and watches
/// whether a correction was one (docs/theory/inertial.md, section 10).
class GyroWatch {
 public:
  /// `configured_offset` (s) as in GyroExpectation.
  GyroWatch(const ImuConfig& config, double configured_offset);

  /// The next reading, as it comes.
  void add(const ImuSample& sample) { monitor_.add(sample); }

  /// With each sweep.
  void note_sweep();
  /// A check failed though the sweep was aligned: the next sweeps are to tell what is wrong,
  /// without the sensor.
  void accuse();
  /// It is to be seen what is wrong before the sensor is started.
  bool is_pending() const { return suspected_ != GyroFault::none || unexplained_ > 0; }

  /// A sweep's alignment, with what it was de-skewed with, if it was. `saturated`: stamps as
  /// GyroExpectation's. `timed`: points have times, so that a sweep's stamp is when it began.
  std::optional<GyroVerdict> check(const StampedPose& alignment, const SweepMotion* deskewed,
                                   const SensorFrame& frame, std::vector<Nanoseconds> saturated,
                                   bool timed);
  /// The gyroscope is known not to work for a while: turns up to now tell nothing.
  void forget();
  /// A sweep without an alignment that holds its rotation.
  void broken() { monitor_.broken(); }

  /// Whether a sweep's turn was predicted better than at constant velocity. After a correction, and
  /// once there are enough: the sensor is as bad as before.
  std::optional<PredictsWorse> note_prediction(bool better_turn);

  /// The latest comparison that the motion constrained.
  const std::optional<RotationComparison>& comparison() const { return comparison_; }

 private:
  std::optional<GyroVerdict> judge(const GyroCheck& check, const SensorFrame& frame, bool timed);

  bool refine_clock_;
  bool refine_mounting_;
  double configured_offset_;  ///< s
  GyroMonitor monitor_;
  GyroFault suspected_ = GyroFault::none;  ///< by the last check
  int corrections_ = 0;                    ///< number of corrected faults
  int unexplained_ = 0;                    ///< sweeps to wait for a comparison, as a check failed
  std::optional<PredictsWorse> trial_;     ///< test of the last correction, so far
  std::optional<RotationComparison> comparison_;
};

}  // namespace adit
