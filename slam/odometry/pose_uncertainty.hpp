// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// How well a sweep's pose is known: covariances of the right perturbation [rho, phi] of
/// T_map_lidar, lidar axes, m and rad (docs/theory/inertial.md, section 9).
struct PoseUncertainty {
  Matrix6d local = Matrix6d::Zero();  ///< relative to the submap
  Matrix6d drift = Matrix6d::Zero();  ///< the submap's since the first sweep, at this lidar

  Matrix6d in_map() const { return local + drift; }
};

/// A pose with how well it is known.
struct UncertainPose {
  Nanoseconds stamp{0};
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  PoseUncertainty uncertainty;
};

/// Covariance of the motion T_from_to between two poses of one odometry, `to` the later one: right
/// perturbation, in the axes of the later lidar. What had drifted before is common to both, and so
/// is most of what two poses a moment apart lack of the submap.
Matrix6d motion_covariance(const UncertainPose& from, const UncertainPose& to);

/// Projector onto the directions of [rho, phi], lidar axes, that no match held.
Matrix6d unheld_directions(const RegistrationResult& alignment);

/// What a sensor without an IMU may have moved by, and turned, besides what its alignments say.
/// Constant velocity is all that they can be held against (docs/theory/inertial.md, section 9).
class UnmeasuredMotion {
 public:
  /// From the last sweep that was aligned to this one: covariance of [rho, phi], lidar axes, that
  /// the step has added. `steady`: where constant velocity led. `unheld`: projector onto the
  /// directions that no match held, in the same axes; zero where all are held.
  Matrix6d step(const StampedPose& found, const Eigen::Isometry3d& steady, const Matrix6d& unheld);

  /// The last step was one that no sensor makes.
  bool leapt() const { return leapt_; }

 private:
  Matrix6d walk(const Eigen::Matrix3d& R_map_lidar, const Matrix6d& unheld, double elapsed);
  /// `expected`: the step from the last pose to the steady one.
  Matrix6d leap(const Eigen::Isometry3d& T_steady_found, const Vector6d& expected, double elapsed);

  std::optional<StampedPose> last_;
  double step_ = 0.0;                     ///< s, between the two before it; 0: there are none
  Matrix6d velocity_ = Matrix6d::Zero();  ///< its covariance, map axes; m/s and rad/s
  Matrix6d mixed_ = Matrix6d::Zero();     ///< of the way made since with it, and the velocity
  bool leapt_ = false;
};

/// Follows what the submap drifts by. Each cloud that joins hands its error on to the sweeps that
/// are aligned with it, which makes a random walk: the more, the better these are known by it than
/// it was itself. So does what a lidar errs by in the same way with every sweep, over the way and
/// the turns that it makes.
class DriftModel {
 public:
  /// A sweep with its local covariance; `joins`: its cloud becomes part of the submap; `besides`:
  /// what its step has added, too (UnmeasuredMotion).
  PoseUncertainty update(const Eigen::Isometry3d& T_map_lidar, const Matrix6d& local, bool joins,
                         const Matrix6d& besides = Matrix6d::Zero());

  /// The first sweep, which holds the map, was bent by a velocity that was known to this: standard
  /// deviations of what its pose lacks, [rho, phi], m and rad, lidar axes.
  void begin_vaguely(const Vector6d& sigma);

  /// The sensor has been at rest since the first sweep: nothing has drifted yet.
  void note_rest();

  /// The submap starts anew at the last sweep: what that one lacks, all after it lack.
  PoseUncertainty restart(const Matrix6d& local);

 private:
  std::optional<Eigen::Isometry3d> last_;  ///< T_map_lidar
  /// Local covariance of the last sweep, where its cloud has joined.
  std::optional<Matrix6d> newest_;
  Matrix6d drift_ = Matrix6d::Zero();  ///< at last_, without what its cloud leaves behind
};

}  // namespace adit
