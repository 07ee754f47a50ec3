// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string_view>

#include "adit/slam/core/nav_state.hpp"

namespace adit {

/// Who measures velocities.
enum class VelocitySource {
  sensor,   ///< wheels, a radar or another odometry, whose scale and mounting are estimated
  doppler,  ///< the range sensor itself, by the Doppler speeds of its points
};
std::string_view to_string(VelocitySource source);
inline constexpr std::size_t kVelocitySources = 2;

/// The way of a sensor of velocities between two times, in body axes at the first: the integral of
/// what it read, turned as the gyroscope says (docs/theory/velocity.md).
struct MeasuredDisplacement {
  Eigen::Vector3d way = Eigen::Vector3d::Zero();  ///< m, as it was read
  /// Its derivative by VelocityCalibration::turn, m/rad.
  Eigen::Matrix<double, 3, 2> by_turn = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();     ///< m², of errors of a velocity
  Eigen::Vector3d p_body_sensor = Eigen::Vector3d::Zero();  ///< m, where the sensor is
  double duration = 0.0;                                    ///< s, greater than 0
  VelocitySource source = VelocitySource::sensor;           ///< who measured it

  /// The way with that calibration, which Doppler speeds do not need.
  Eigen::Vector3d calibrated(const VelocityCalibration& calibration) const {
    return source == VelocitySource::doppler
               ? way
               : Eigen::Vector3d((1.0 + calibration.scale) * (way + by_turn * calibration.turn));
  }
};

/// The last velocities of one sensor, in order of time.
class VelocityBuffer {
 public:
  /// One that is not after the newest is dropped: false.
  bool add(const BodyVelocity& velocity);
  /// Drops what no interval from `stamp` on needs.
  void forget_before(Nanoseconds stamp);
  bool empty() const { return velocities_.empty(); }

  /// The velocity then, by its neighbours in time, NaN on axes that are not measured; nothing where
  /// they are too far apart, or where only an earlier one is known that is as old as that.
  std::optional<BodyVelocity> at(Nanoseconds stamp) const;

 private:
  std::deque<BodyVelocity> velocities_;
};

/// Over the time of the readings, whose ends are the two times. `sigma`: standard deviation (m/s)
/// of a velocity without a covariance. The errors of a velocity are taken to stay the same between
/// the two times, so that more of them are not better known. Nothing where the velocities do not
/// cover that time.
std::optional<MeasuredDisplacement> measured_displacement(const VelocityBuffer& velocities,
                                                          std::span<const ImuSample> readings,
                                                          const Eigen::Vector3d& gyro_bias,
                                                          const Eigen::Isometry3d& T_body_sensor,
                                                          double sigma);

}  // namespace adit
