// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A time without sweeps, and what the sensor can have done in it (docs/theory/odometry.md,
// section 3).
#pragma once

#include <deque>
#include <optional>
#include <span>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"

namespace adit {

/// A time since the last aligned sweep that no velocity bridges: what the sensor can have done.
struct Silence {
  double seconds = 0.0;  ///< s, since the last sweep that was aligned
  /// Where the sensor is expected, T_map_lidar.
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  /// Standard deviations of that pose, [rho, phi], m and rad, lidar axes.
  Vector6d sigma = Vector6d::Zero();
  /// m, from the last aligned sweep: 99 % of such motions end nearer.
  double distance = 0.0;
};

/// Squared Mahalanobis distance of a pose (T_map_lidar) from where it is expected: chi squared of
/// six degrees of freedom.
double chi2_of(const Silence& silence, const Eigen::Isometry3d& T_map_lidar);

/// 99 % of motions in the plane end within so many standard deviations.
inline constexpr double kPlanarSigmas = 3.035;

/// A pose after a silence that is in 99 % of all motions stays below: chi squared of six degrees of
/// freedom.
inline constexpr double kSilenceGate = 16.81;

/// The pose after `elapsed` s of a sensor that moved with `velocity` (body twist, m/s and rad/s;
/// none: it is unknown) at `from`, and whose highest speed so far is `fastest` (m/s). Its velocity
/// changes by white acceleration and reverts to zero: docs/theory/odometry.md, section 3.
Silence silence_after(const Eigen::Isometry3d& from, const std::optional<Vector6d>& velocity,
                      double fastest, double elapsed);

/// How far apart sweeps are by their stamps.
class SweepRhythm {
 public:
  /// Each sweep, in their order.
  void add(const Sweep& sweep);
  /// s, the median of the last intervals, or how long a sweep lasts; none: neither is known yet.
  std::optional<double> usual() const;

 private:
  std::optional<Nanoseconds> last_;
  std::optional<double> duration_;
  std::deque<double> intervals_;  ///< s
};

/// m, nine in ten returns are nearer; 0 without a return.
double reach_of(std::span<const Point> points);

}  // namespace adit
