// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/preintegration.hpp"

#include <cmath>

namespace adit {
namespace {

constexpr double kStaleRotation = 2e-3;  // rad
constexpr double kStaleAccelBias = 0.2;  // m/s²

// Across a gap readings are taken to go straight from one to the next. What the means of rate and
// acceleration may be off by then, at least; else by half of what the ends differ.
constexpr double kGapRate = 0.05;  // rad/s
constexpr double kGapForce = 0.5;  // m/s²

// Places in the covariance.
constexpr int kPosition = 0;
constexpr int kRotation = 3;
constexpr int kVelocity = 6;

/// Variance of the mean rate and acceleration between two readings that are far apart.
Vector6d gap_variance(const ImuSample& from, const ImuSample& to) {
  const double rate = 0.5 * (to.angular_velocity - from.angular_velocity).norm();
  const double force = 0.5 * (to.linear_acceleration - from.linear_acceleration).norm();
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(rate * rate + kGapRate * kGapRate),
      Eigen::Vector3d::Constant(force * force + kGapForce * kGapForce);
  return variance;
}

}  // namespace

Preintegration advanced(const Preintegration& so_far, const ImuSample& from, const ImuSample& to,
                        const ImuNoise& noise) {
  const double dt = seconds(to.stamp - from.stamp);
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Eigen::Vector3d omega =
      0.5 * (from.angular_velocity + to.angular_velocity) - so_far.bias.gyro;
  const Eigen::Vector3d accel =
      0.5 * (from.linear_acceleration + to.linear_acceleration) - so_far.bias.accel;

  const Eigen::Matrix3d step = so3_exp(omega * dt);
  const Eigen::Matrix3d half_step = so3_exp(0.5 * omega * dt);
  const Eigen::Matrix3d step_jacobian = so3_right_jacobian(omega * dt);
  const Eigen::Matrix3d half_jacobian = so3_right_jacobian(0.5 * omega * dt);
  const Eigen::Matrix3d middle = so_far.increment.rotation * half_step;  // R at mid-interval
  const Eigen::Matrix3d tilt = middle * skew(accel);

  Preintegration next = so_far;
  next.duration += dt;
  next.increment.position += so_far.increment.velocity * dt + 0.5 * dt * dt * (middle * accel);
  next.increment.velocity += dt * (middle * accel);
  next.increment.rotation = so_far.increment.rotation * step;

  // By the biases: of the rotation at mid-interval first.
  const Eigen::Matrix3d middle_by_gyro =
      half_step.transpose() * so_far.rotation_by_gyro - 0.5 * dt * half_jacobian;
  next.position_by_accel += so_far.velocity_by_accel * dt - 0.5 * dt * dt * middle;
  next.position_by_gyro += so_far.velocity_by_gyro * dt - 0.5 * dt * dt * tilt * middle_by_gyro;
  next.velocity_by_accel -= dt * middle;
  next.velocity_by_gyro -= dt * tilt * middle_by_gyro;
  next.rotation_by_gyro = step.transpose() * so_far.rotation_by_gyro - dt * step_jacobian;

  // Covariance: transition, then the noise of the two sensors, white of variance density / dt.
  Matrix9d transition = Matrix9d::Identity();
  const Eigen::Matrix3d tilt_before = tilt * half_step.transpose();
  transition.block<3, 3>(kRotation, kRotation) = step.transpose();
  transition.block<3, 3>(kVelocity, kRotation) = -dt * tilt_before;
  transition.block<3, 3>(kPosition, kRotation) = -0.5 * dt * dt * tilt_before;
  transition.block<3, 3>(kPosition, kVelocity) = dt * identity;
  Eigen::Matrix<double, 9, 6> input = Eigen::Matrix<double, 9, 6>::Zero();
  input.block<3, 3>(kRotation, 0) = dt * step_jacobian;
  input.block<3, 3>(kVelocity, 0) = -0.5 * dt * dt * tilt * half_jacobian;
  input.block<3, 3>(kPosition, 0) = 0.5 * dt * input.block<3, 3>(kVelocity, 0);
  input.block<3, 3>(kVelocity, 3) = dt * middle;
  input.block<3, 3>(kPosition, 3) = 0.5 * dt * dt * middle;
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(noise.gyro * noise.gyro / dt),
      Eigen::Vector3d::Constant(noise.accel * noise.accel / dt);
  if (dt > kReadingGap) {
    variance += gap_variance(from, to);
  }
  next.covariance = transition * so_far.covariance * transition.transpose() +
                    input * variance.asDiagonal() * input.transpose();
  next.scale = noise.scale;
  return next;
}

// An error S with independent entries of variance s^2 moves a vector a by S a: cov(S a, S b) =
// s^2 (a . b) I.
Matrix9d whole_covariance(const Preintegration& preintegration) {
  const MotionIncrement& increment = preintegration.increment;
  const double variance = preintegration.scale * preintegration.scale;
  const Eigen::Vector3d turn = so3_log(increment.rotation);
  const auto add = [&](Matrix9d& sum, int i, int j, double product) {
    sum.block<3, 3>(i, j).diagonal().array() += variance * product;
  };
  Matrix9d sum = preintegration.covariance;
  add(sum, kRotation, kRotation, turn.squaredNorm());
  add(sum, kVelocity, kVelocity, increment.velocity.squaredNorm());
  add(sum, kPosition, kPosition, increment.position.squaredNorm());
  add(sum, kVelocity, kPosition, increment.velocity.dot(increment.position));
  add(sum, kPosition, kVelocity, increment.velocity.dot(increment.position));
  return sum;
}

Preintegration preintegrate(std::span<const ImuSample> samples, const ImuBias& bias,
                            const ImuNoise& noise) {
  Preintegration sum;
  sum.bias = bias;
  for (size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].stamp > samples[i - 1].stamp) {
      sum = advanced(sum, samples[i - 1], samples[i], noise);
    }
  }
  return sum;
}

MotionIncrement corrected(const Preintegration& preintegration, const ImuBias& bias) {
  const Eigen::Vector3d gyro = bias.gyro - preintegration.bias.gyro;
  const Eigen::Vector3d accel = bias.accel - preintegration.bias.accel;
  const MotionIncrement& increment = preintegration.increment;
  return {.rotation = increment.rotation * so3_exp(preintegration.rotation_by_gyro * gyro),
          .velocity = increment.velocity + preintegration.velocity_by_gyro * gyro +
                      preintegration.velocity_by_accel * accel,
          .position = increment.position + preintegration.position_by_gyro * gyro +
                      preintegration.position_by_accel * accel};
}

bool is_stale(const Preintegration& preintegration, const ImuBias& bias) {
  const Eigen::Vector3d turned =
      preintegration.rotation_by_gyro * (bias.gyro - preintegration.bias.gyro);
  return turned.norm() > kStaleRotation ||
         (bias.accel - preintegration.bias.accel).norm() > kStaleAccelBias;
}

NavState predict(const NavState& state, const Preintegration& preintegration) {
  const MotionIncrement increment = corrected(preintegration, state.bias);
  const double t = preintegration.duration;
  const Eigen::Matrix3d& R_map_body = state.T_map_body.linear();
  NavState next = state;
  next.stamp += nanoseconds(t);
  next.T_map_body.linear() = R_map_body * increment.rotation;
  next.T_map_body.translation() +=
      t * state.v_map_body + 0.5 * t * t * state.gravity_map + R_map_body * increment.position;
  next.v_map_body += t * state.gravity_map + R_map_body * increment.velocity;
  next.T_map_body = orthonormalized(next.T_map_body);
  return next;
}

}  // namespace adit
