// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace adit {

/// A body in motion.
struct MotionState {
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< world, m/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      ///< world, m/s², without gravity
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< body, rad/s
};

/// A cumulative cubic B-spline through SO(3) x R3 with even knots. Velocity, acceleration and
/// angular velocity are its exact derivatives, by the recursion of Sommer et al. (2020), "Efficient
/// derivative computation for cumulative B-splines on Lie groups"; they are continuous.
class SplineTrajectory {
 public:
  /// Control pose i belongs to the time (i - 1) * `spacing` (s); neighbours differ by less than
  /// half a turn. At least four. The spline passes near them, not through them.
  SplineTrajectory(double spacing, std::vector<Eigen::Isometry3d> control_poses);

  /// From 0 to here the spline is defined (s).
  double duration() const { return spacing_ * static_cast<double>(segments_.size()) - cut_length_; }

  /// The same motion without `length` seconds of it: at the time `begin` (s) the body is at once
  /// where it would be that much later.
  SplineTrajectory cut_out(double begin, double length) const;

  /// The motion at a time (s), held at the ends of the spline.
  MotionState at(double time) const;

  /// The pose alone.
  Eigen::Isometry3d pose(double time) const;

 private:
  /// What is the same between two knots: the first pose and the steps to the next three.
  struct Segment {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d position;
    std::array<Eigen::Vector3d, 3> turns;
    std::array<Eigen::Vector3d, 3> moves;
  };
  struct Place {
    const Segment* segment;
    double u;  ///< 0 to 1
  };

  Place find(double time) const;

  double spacing_;
  std::vector<Segment> segments_;
  double cut_begin_ = std::numeric_limits<double>::infinity();  ///< s
  double cut_length_ = 0.0;                                     ///< s
};

}  // namespace adit
