// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// From aligned sweeps and the readings between them to a sensor that can be fused.
#pragma once

#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "adit/slam/fusion/inertial_event.hpp"
#include "adit/slam/fusion/inertial_readings.hpp"
#include "adit/slam/fusion/state_prior.hpp"
#include "adit/slam/inertial/preintegration.hpp"

namespace adit {

/// Aligned sweeps in a row, the newest few.
class StartCollection {
 public:
  /// Poses of the body. `since`: what was read since the last of them; without, it begins anew.
  /// `unheld`: directions, unit, map axes, in which nothing held its position.
  void add(const StampedPose& T_map_body, std::optional<std::vector<ImuSample>> since,
           std::vector<Eigen::Vector3d> unheld = {});
  /// A sweep of that time could not be aligned. One empty message ends nothing; after a longer time
  /// the next pose may be in the wrong place, and the collection begins anew.
  void note_unaligned(Nanoseconds stamp);
  void clear();

  const std::deque<StampedPose>& poses() const { return poses_; }
  /// Between each pose and the next, in the accelerometer's own unit.
  const std::deque<std::vector<ImuSample>>& readings() const { return readings_; }
  /// Of each pose.
  const std::deque<std::vector<Eigen::Vector3d>>& unheld() const { return unheld_; }

 private:
  std::deque<StampedPose> poses_;
  std::deque<std::vector<ImuSample>> readings_;
  std::deque<std::vector<Eigen::Vector3d>> unheld_;
};

/// What a start still needs of aligned sweeps; nothing where there are enough.
std::optional<InertialHindrance> few_aligned(const StartCollection& collected);

/// A sensor as it was when it was fused last.
struct FusedBefore {
  NavState state;
  double accel_scale = 1.0;
  bool sign_assumed = false;  ///< the accelerometer's sign, not confirmed by the motion since
};

/// Where fusion begins.
struct SensorStart {
  NavState state;
  ImuStart how;
  Nanoseconds since{0};  ///< stamp of the first sweep that it follows from
};

/// What the accelerometer's mean at rest (m/s², body) tells of attitude, bias and gravity together:
/// R_map_body (reading - b_a) + g = 0 to `sigma` m/s².
StateFactor<3> rest_factor(const Eigen::Vector3d& reading, const NavState& state, double sigma);

/// Standard deviations of what the calibration of a sensor of velocities lacks at first.
struct CalibrationSigma {
  double scale = 0.05;
  double turn = 0.05;  ///< rad
};

/// The prior that the sliding graph begins with.
StatePrior prior_of(const SensorStart& start, const CalibrationSigma& calibration = {});

/// How a try ended: there are too few sweeps to try, something is in the way, or the sensor starts.
using StartAttempt = std::variant<std::monostate, InertialHindrance, SensorStart>;

/// Tries a start, at rest if the sweeps hardly moved and else in motion.
StartAttempt try_start(const StartCollection& collected, const InertialReadings& readings,
                       const ImuNoise& noise, const std::optional<FusedBefore>& before);

/// A start after a time without readings, with gravity, unit and biases from before: the velocity
/// follows from the last two poses, of which there must be that many.
SensorStart start_after_gap(const StartCollection& collected, const ImuNoise& noise,
                            const FusedBefore& before);

/// The velocity of the body (m/s, map) at the second of two poses, which gives the way between
/// them, with what was integrated in that time and with gravity (m/s², map).
Eigen::Vector3d velocity_after(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second,
                               const Preintegration& between, const Eigen::Vector3d& gravity_map);

}  // namespace adit
