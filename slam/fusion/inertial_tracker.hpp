// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/prediction.hpp"
#include "adit/slam/fusion/fused_motion.hpp"
#include "adit/slam/fusion/gyro_watch.hpp"
#include "adit/slam/fusion/inertial_readings.hpp"
#include "adit/slam/fusion/inertial_report.hpp"
#include "adit/slam/fusion/sensor_start.hpp"
#include "adit/slam/inertial/sweep_motion.hpp"

namespace adit {

/// The noise that the settings assume: a sensor's by name, or their own.
ImuNoise imu_noise(const ImuConfig& config);

/// What the readings say of the next sweep.
struct InertialPrediction {
  Prediction lidar;
  std::optional<SweepMotion> motion;  ///< none for a sweep without duration
};

// What a prediction must be better than to be aligned from without a search.
inline constexpr double kTrustedPosition = 0.25;  ///< m
inline constexpr double kTrustedRotation = 0.05;  ///< rad

/// How the lidar moved from one time to another, by measured velocities and the gyroscope.
struct MeasuredMotion {
  Eigen::Isometry3d T_begin_end = Eigen::Isometry3d::Identity();
  Matrix6d covariance =
      Matrix6d::Identity();  ///< of that, right perturbation [rho, phi], m and rad
};

/// Starts the inertial sensor, predicts sweeps with it, fuses it with their alignments in the
/// sliding graph, and checks that it does what it should (docs/theory/inertial.md, section 6).
class InertialTracker {
 public:
  /// `config` must have passed validate(). `configured_offset` (s) is what the stamps of readings
  /// have in them of recording.imu_time_offset: remedies name the sum.
  explicit InertialTracker(const ImuConfig& config, double configured_offset = 0.0,
                           const VelocityConfig& velocity = {});

  /// In place of the settings' mounting. What was started with another one starts anew.
  void mount(const Eigen::Isometry3d& T_imu_lidar);

  /// Takes a reading. Returns those whose fate is known with it: one that jumps waits for the next.
  std::vector<TakenReading> add(const ImuSample& sample);

  /// Takes what a sensor of velocities measured, or the sweeps' Doppler speeds, in lidar axes. One
  /// that is not after the newest is dropped.
  void add(const BodyVelocity& velocity, VelocitySource source);
  /// Where that sensor is on the lidar, in place of the settings' mounting.
  void mount_velocity(const Eigen::Isometry3d& T_lidar_sensor) {
    T_lidar_velocity_ = T_lidar_sensor;
  }

  /// Attitude of the lidar in a map whose z is up, as the readings of that time have it: within a
  /// few degrees for a sensor that moves. None without readings.
  std::optional<Eigen::Matrix3d> level_lidar(Nanoseconds begin, Nanoseconds end) const;

  /// Before the first start: the readings of that time are those of a sensor at rest, or of one
  /// that goes on as it went.
  bool is_quiet_between(Nanoseconds begin, Nanoseconds end) const;

  /// The sweep that begins at `stamp` and lasts `duration` s. None while the sensor is not fused.
  std::optional<InertialPrediction> predict(Nanoseconds stamp, double duration);

  /// Before the first start the gyroscope alone can be used, with its bias: how the lidar turned in
  /// that time, R_begin_end. None once started, without readings, or if it turned otherwise than
  /// alignments said.
  std::optional<Eigen::Matrix3d> turn(Nanoseconds begin, Nanoseconds end) const;
  /// The same over a sweep, with the translation of a constant velocity (m/s, lidar axes).
  std::optional<SweepMotion> turning_motion(Nanoseconds stamp, double duration,
                                            const Eigen::Vector3d& velocity) const;

  /// Before the first start the velocities that are measured tell how the lidar moved. None once
  /// started, without readings or velocities, where these leave the place uncertain by more than
  /// kTrustedPosition, or once alignments have contradicted them.
  std::optional<MeasuredMotion> measured_motion(Nanoseconds begin, Nanoseconds end) const;

  /// The pose of a sweep that was aligned, or bridged by a prediction where `alignment` is null;
  /// `steady` is what constant velocity predicted, `deskewed` what the sweep was de-skewed with, if
  /// it was. Where the report has a nav, that is the outcome.
  InertialReport update(const StampedPose& T_map_lidar, const RegistrationResult* alignment,
                        const Eigen::Isometry3d& steady, const SweepMotion* deskewed = nullptr);

  /// The map begins with this sweep: its pose is known by definition.
  void note_begin(const StampedPose& T_map_lidar);

  /// The submap starts anew: where no inertial prediction led there, the attitude is not the one
  /// from before, nor is gravity's direction in the map.
  void note_restart();

  /// What nav says of the lidar.
  Eigen::Isometry3d T_map_lidar(const NavState& nav) const {
    return nav.T_map_body * T_body_lidar_;
  }

 private:
  struct Absent {};
  struct Starting {
    StartCollection collected{};
    bool gyro_agrees = true;       ///< with alignments, as far as was seen
    bool velocities_agree = true;  ///< likewise
  };
  struct Fused {
    FusedMotion motion;
    double gap = 0.0;  ///< s, that the prediction of the sweep under way bridges; 0: none
    std::vector<Eigen::Vector3d> unheld{};  ///< map axes: where no match of the last sweep held it
  };
  struct Lost {
    StartCollection collected{};
    bool after_gap = false;  ///< for want of readings alone: gravity and biases still hold
  };
  struct Refused {};
  /// In the order of InertialState.
  using State = std::variant<Absent, Starting, Fused, Lost, Refused>;

  /// What is kept whatever the state.
  struct History {
    std::optional<NavState> fused;          ///< the last state that was
    double accel_scale = 1.0;               ///< by the last start
    std::optional<Nanoseconds> bridged_at;  ///< the last gap among the readings that was bridged
    /// Position in the map of a start at rest: the accelerometer's sign is an assumption until the
    /// sensor has gone away from there.
    std::optional<Eigen::Vector3d> rested_at;
    /// A start in motion did not tell the sign either: an assumption for a long time of fusion.
    bool moved_unclearly = false;
    int losses = 0;  ///< since the last long time of fusion
    /// A check failed: an axis that has stayed as it was since then may be why.
    std::optional<Nanoseconds> failed_at;

    bool is_sign_assumed() const { return rested_at.has_value() || moved_unclearly; }
  };

  InertialState state() const { return static_cast<InertialState>(state_.index()); }
  template <class Kind>
  bool is() const {
    return std::holds_alternative<Kind>(state_);
  }
  StartCollection* collected();

  std::vector<ImuSample> scaled(std::vector<ImuSample> samples) const;
  std::optional<CoverageFault> fault_of(const ImuInterval& interval) const;
  std::optional<InertialPrediction> predict(Fused& fused, Nanoseconds stamp, double duration);
  void fuse(Fused& fused, const RegistrationResult* alignment, const Eigen::Isometry3d& steady,
            InertialReport& report);
  /// What sensors of velocities measured since the last sweep.
  std::vector<MeasuredDisplacement> ways_until(Nanoseconds stamp, const NavState& from) const;
  void collect(const StampedPose& T_map_lidar, std::vector<Eigen::Vector3d> unheld);
  void compare_velocities(Nanoseconds stamp, const RegistrationResult& alignment);
  void start_if_possible();
  void start(const SensorStart& start);
  void watch(const StampedPose& alignment, const SweepMotion* deskewed);

  /// What else explains a check that failed, and passes: saturation within the last ten seconds, a
  /// gap that was bridged.
  std::optional<PassingCause> passing_cause() const;
  /// An axis that is stuck. Where the others hardly move only if a check has failed, twenty
  /// seconds ago at most, while it was.
  std::optional<StuckAxis> stuck_axis() const;
  /// A check has failed by what the readings say: a loss with the axis that is stuck, if one is.
  bool lose_by_axis();
  /// After a check that failed.
  void lose(const FailedCheck& check);
  /// Goes on in another state, for that reason.
  void leave(State next, const InertialCause& why);

  ImuConfig config_;
  ImuNoise noise_;
  Eigen::Isometry3d T_body_lidar_;
  VelocityConfig velocity_;
  Eigen::Isometry3d T_lidar_velocity_;
  InertialReadings readings_;
  std::array<VelocityBuffer, kVelocitySources> velocities_;  ///< by VelocitySource
  GyroWatch watch_;
  bool timed_ = false;  ///< points have times: a sweep's stamp is when it began
  State state_;
  History history_;
  std::optional<InertialEvent> event_;
  std::optional<InertialHindrance> hindrance_;
};

}  // namespace adit
