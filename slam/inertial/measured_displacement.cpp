// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/measured_displacement.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

// Between neighbours farther apart the velocity is not known: the slowest sources give five a
// second, and one may be missing.
constexpr Nanoseconds kFarthestApart = std::chrono::milliseconds(450);
// m/s. What a velocity may be on an axis that is not measured: somebody who is carried or driven
// hardly goes faster sideways.
constexpr double kUnmeasured = 10.0;

/// A velocity with zero where nothing is measured, and its variances.
struct Known {
  Eigen::Vector3d linear;
  Eigen::Matrix3d covariance;
};

Known known(const BodyVelocity& velocity, double sigma) {
  Known result{.linear = velocity.linear,
               .covariance = velocity.covariance.value_or(
                   Eigen::Matrix3d(sigma * sigma * Eigen::Matrix3d::Identity()))};
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(velocity.linear[axis])) {
      result.linear[axis] = 0.0;
      result.covariance.row(axis).setZero();
      result.covariance.col(axis).setZero();
      result.covariance(axis, axis) = kUnmeasured * kUnmeasured;
    }
  }
  return result;
}

}  // namespace

std::string_view to_string(VelocitySource source) {
  switch (source) {
    case VelocitySource::sensor:
      return "sensor";
    case VelocitySource::doppler:
      return "doppler";
  }
  return "unknown";
}

bool VelocityBuffer::add(const BodyVelocity& velocity) {
  if (!velocities_.empty() && velocity.stamp <= velocities_.back().stamp) {
    return false;
  }
  velocities_.push_back(velocity);
  return true;
}

void VelocityBuffer::forget_before(Nanoseconds stamp) {
  while (velocities_.size() > 1 && velocities_[1].stamp <= stamp) {
    velocities_.pop_front();
  }
}

std::optional<BodyVelocity> VelocityBuffer::at(Nanoseconds stamp) const {
  const auto after = std::ranges::lower_bound(velocities_, stamp, {}, &BodyVelocity::stamp);
  if (after == velocities_.end()) {
    const bool stands =
        !velocities_.empty() && stamp - velocities_.back().stamp <= kFarthestApart / 2;
    return stands ? std::optional(velocities_.back()) : std::nullopt;
  }
  if (after->stamp == stamp) {
    return *after;
  }
  if (after == velocities_.begin()) {
    return std::nullopt;
  }
  const BodyVelocity& before = *std::prev(after);
  if (after->stamp - before.stamp > kFarthestApart) {
    return std::nullopt;
  }
  const double share = seconds(stamp - before.stamp) / seconds(after->stamp - before.stamp);
  BodyVelocity between = share < 0.5 ? before : *after;
  between.stamp = stamp;
  between.linear = (1.0 - share) * before.linear + share * after->linear;
  return between;
}

std::optional<MeasuredDisplacement> measured_displacement(const VelocityBuffer& velocities,
                                                          std::span<const ImuSample> readings,
                                                          const Eigen::Vector3d& gyro_bias,
                                                          const Eigen::Isometry3d& T_body_sensor,
                                                          double sigma) {
  MeasuredDisplacement result{.p_body_sensor = T_body_sensor.translation()};
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  // R_begin_body, as it goes on
  Eigen::Matrix3d variances = Eigen::Matrix3d::Zero();
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const ImuSample& from = readings[i - 1];
    const ImuSample& to = readings[i];
    const double dt = seconds(to.stamp - from.stamp);
    if (!(dt > 0.0)) {
      continue;
    }
    const auto velocity = velocities.at(from.stamp + (to.stamp - from.stamp) / 2);
    if (!velocity) {
      return std::nullopt;
    }
    const Eigen::Vector3d turn =
        dt * (0.5 * (from.angular_velocity + to.angular_velocity) - gyro_bias);
    const Eigen::Matrix3d R_begin_sensor = R * so3_exp(0.5 * turn) * T_body_sensor.linear();
    const Known one = known(*velocity, sigma);
    result.way += dt * (R_begin_sensor * one.linear);
    result.by_turn -= dt * (R_begin_sensor * skew(one.linear)).rightCols<2>();
    variances += dt * (R_begin_sensor * one.covariance * R_begin_sensor.transpose());
    result.duration += dt;
    R = R * so3_exp(turn);
  }
  if (!(result.duration > 0.0)) {
    return std::nullopt;
  }
  // The mean of the variances of a velocity, over the whole time.
  result.covariance = result.duration * variances;
  return result;
}

}  // namespace adit
