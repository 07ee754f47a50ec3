// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "slam/config.hpp"
#include "slam/lie.hpp"
#include "slam/types.hpp"

namespace adit::engine {
class Context;
}

namespace adit {

/// How an alignment ended. Only `converged` is a success; the others say why the pose is not to be used.
enum class RegistrationStatus {
  converged,
  not_converged,       ///< still moving after max_iterations
  too_little_overlap,  ///< matched fraction below min_overlap
  too_few_points,      ///< matched points below min_inliers, or an empty source or target
  diverged,            ///< the step or the pose is not finite, or left the target's extent
};
std::string_view to_string(RegistrationStatus status);

/// Result of aligning a source cloud with a target. The Hessian and residuals are those at the final pose.
struct RegistrationResult {
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  RegistrationStatus status = RegistrationStatus::too_few_points;
  Matrix6d hessian = Matrix6d::Zero();  ///< [rho, phi] of T_target_source, right perturbation; 1/m^2, 1/(m rad), 1/rad^2
  Vector6d gradient = Vector6d::Zero();
  double cost = 0.0;          ///< sum of e^T Omega e over the inliers
  double residual_rms = 0.0;  ///< m, root mean square distance along the target's normals over the inliers
  double overlap = 0.0;       ///< inliers / source points
  int inliers = 0;
  int source_points = 0;
  int iterations = 0;
};

/// What the odometry knows after a sweep.
enum class OdometryState {
  initializing,  ///< the submap has been started with this sweep
  tracking,      ///< aligned with the submap
  coasting,      ///< alignment failed; the pose is the prediction, the sweep was left out of the submap
  restarted,     ///< too many failures in a row: the submap starts anew at the predicted pose
};
std::string_view to_string(OdometryState state);

/// Time of one stage of a sweep.
struct StageTime {
  std::string_view stage;
  double device_ms = 0.0;  ///< between device timestamps; 0 where the stage has no device work
};

/// What Odometry::step() tells of a sweep.
struct SweepResult {
  Nanoseconds stamp{0};
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  OdometryState state = OdometryState::initializing;
  RegistrationResult registration;  ///< T_target_source = T_map_lidar before drift handling; default at the first sweep
  bool keyframe = false;            ///< far enough from the last keyframe; false while coasting
  int raw_points = 0;               ///< points of the sweep as it came
  int valid_points = 0;             ///< left after NaN, no-return and range clipping
  std::vector<Point> cloud;         ///< keyframes only: the down-sampled sweep, lidar frame
  std::vector<StageTime> stages;    ///< device time by stage (empty unless the context profiles)
  double host_ms = 0.0;             ///< host work: decode into staging, record, read back
  double wait_ms = 0.0;             ///< host time spent waiting for the device
};

/// LiDAR odometry: constant-velocity prediction, alignment against a rolling submap of the last l clouds.
///
/// One device submission and one host wait a sweep. The map frame is the lidar frame of the first sweep.
/// On one device the same sweeps give the same bytes.
class Odometry {
 public:
  /// Throws engine::Error if the device runs out of memory. `config` must have passed validate().
  Odometry(engine::Context& context, const Config& config);
  ~Odometry();
  Odometry(const Odometry&) = delete;
  Odometry& operator=(const Odometry&) = delete;

  /// Takes the next sweep. Sweeps without a valid point are a failure like any other: coasting.
  SweepResult step(const Sweep& sweep);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit
