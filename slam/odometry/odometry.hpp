// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/engine/submission.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/fusion/inertial_tracker.hpp"
#include "adit/slam/odometry/pose_uncertainty.hpp"
#include "adit/slam/odometry/rejection.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit::engine {
class Context;
}

namespace adit {

/// What the odometry knows after a sweep.
enum class OdometryState {
  initializing,  ///< the submap has been started with this sweep
  tracking,      ///< aligned with the submap
  coasting,  ///< alignment failed; the pose is the prediction, the sweep was left out of the submap
  restarted,  ///< too many failures in a row, or too long a silence: the submap starts anew at the
              ///< predicted pose, which is a guess
};
/// The enumerator's name.
std::string_view to_string(OdometryState state);

/// Time of one stage of a sweep.
struct StageTime {
  std::string stage;       ///< its name
  double device_ms = 0.0;  ///< between device timestamps; 0 where the stage has no device work
};

/// When the host worked on a sweep and the device did, on the host's steady clock.
struct SweepClock {
  std::chrono::steady_clock::time_point begun{};      ///< the host took it up
  std::chrono::steady_clock::time_point submitted{};  ///< the device had its work
  std::chrono::steady_clock::time_point done{};       ///< that was done, or seen to be so
  std::chrono::steady_clock::time_point ended{};      ///< the host had the result
};

/// What Odometry::step() tells of a sweep.
struct SweepResult {
  Nanoseconds stamp{0};                                           ///< of the sweep's start
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();  ///< pose at that time
  PoseUncertainty uncertainty;                                    ///< covariances of that pose
  OdometryState state = OdometryState::initializing;              ///< how the pose came about
  RegistrationResult
      registration;  ///< T_target_source is T_map_lidar; all default at the first sweep
  std::optional<Rejection> rejection;  ///< why an alignment is rejected
  bool displacement_measured =
      false;              ///< by velocities, where the inertial sensor has not started yet
  bool searched = false;  ///< aligned a second time, from several places: the first fell short
  /// Without an IMU: the step to here takes more acceleration than a sensor has, so that it or the
  /// ones before are wrong.
  bool leapt = false;
  /// The readings have told that the sensor was at rest since the map began.
  bool rested = false;
  bool keyframe = false;  ///< far enough from the last keyframe; never while coasting
  int raw_points = 0;     ///< points of the sweep as it came
  int valid_points = 0;   ///< left after NaN, no-return and range clipping
  int cloud_points = 0;   ///< left after down-sampling
  int lost_points =
      0;  ///< found no place in a table on the device or in the submap's extent; 0 is normal
  int moving_points = 0;    ///< that Doppler speeds showed to move: taken out before anything else
  int crowded_voxels = 0;   ///< of the submap: times that one held more than 65 535 points
  InertialReport inertial;  ///< state of the inertial sensor, where there is one
  bool deskewed = false;    ///< points were moved to the sweep's start
  /// rad, rotation vector from the attitude at the sweep's start to the mean one over the sweep, as
  /// de-skewing assumed it.
  Eigen::Vector3d deskewed_turn = Eigen::Vector3d::Zero();
  std::vector<Point> cloud;  ///< keyframes only: the down-sampled sweep, lidar frame
  /// Coasted for so long that the submap starts anew, at a pose that inertia knows.
  bool renewed = false;
  /// s, since the last sweep that was aligned, where no velocity and no trusted inertia bridges
  /// that; 0 else.
  double silence = 0.0;
  std::vector<StageTime> stages;     ///< device time by stage (empty unless the context profiles)
  engine::RecordedWork device_work;  ///< what the device was given to do
  double host_ms = 0.0;              ///< host work: copy into staging, record, read back
  double inertial_ms = 0.0;          ///< part of host_ms: preintegration and the sliding graph
  double wait_ms = 0.0;              ///< host time spent waiting for the device
  SweepClock clock{};                ///< of the first submission; later ones end before `ended`
};

/// Odometry from a range sensor and, where there is one, an inertial sensor: prediction of the
/// sweep's motion, alignment against a rolling submap of the last l clouds, fusion in a sliding
/// graph. Without inertial readings, or while they fail a check, motion is predicted at constant
/// velocity.
///
/// One device submission and one host wait a sweep; more where the alignment takes more steps than
/// the last ones did, or falls short of what is usual and is searched for again, and at the second
/// sweep of all. The map frame has
/// its origin at the lidar of the first sweep; with an inertial sensor its z is up as that saw it
/// then, without one its axes are the lidar's. On one device the same input gives the same bytes.
class Odometry {
 public:
  /// Throws engine::Error if the device runs out of memory. `config` must have passed validate().
  Odometry(engine::Context& context, const Config& config);
  ~Odometry();
  Odometry(const Odometry&) = delete;
  Odometry& operator=(const Odometry&) = delete;

  /// How the sensors are mounted to each other, in place of imu.T_imu_lidar. An inertial sensor
  /// that was started with another mounting starts anew.
  void mount(const Eigen::Isometry3d& T_imu_lidar);

  /// Takes an inertial reading, in the sensor's own units. A sweep wants all of them from before
  /// its stamp to its end. Returns the readings whose fate is known with it.
  std::vector<TakenReading> add(const ImuSample& sample);

  /// Takes what a sensor of velocities measured, or the sweeps' Doppler speeds (fit_doppler()); it
  /// counts where an inertial sensor is fused. A sweep wants all of them from before its stamp.
  void add(const BodyVelocity& velocity, VelocitySource source = VelocitySource::sensor);
  /// Where that sensor is on the lidar, in place of velocity.T_lidar_sensor.
  void mount_velocity(const Eigen::Isometry3d& T_lidar_sensor);

  /// Takes the next sweep. Sweeps without a valid point are a failure like any other: coasting.
  /// The same as begin() and finish().
  SweepResult step(const Sweep& sweep);

  /// The half of a step before the device: predicts, uploads and submits, and does not wait. Until
  /// finish() readings may come, another sweep may not.
  void begin(const Sweep& sweep);
  /// The half behind it: waits for the device, fuses and decides. A begin() must have come before.
  SweepResult finish();

  /// The configuration in force: lengths that were left at 0 are as the first sweep shows them.
  const Config& config() const;

  /// The sweep finished last: down-sampled, lidar axes, m.
  std::vector<Point> cloud() const;

 private:
  void derive_lengths(const Sweep& sweep);

  struct Impl;
  Config stated_;
  bool derived_ = false;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit
