// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/wheel_model.hpp"

#include <cmath>

#include "adit/tools/simulator/counter_random.hpp"

namespace adit {
namespace {

// A wheel of 0.16 m radius with an encoder of 2000 ticks a turn.
constexpr double kTick = 0.0005;  // m
// Load and pressure change the radius of a tyre by about that.
constexpr double kScaleSigma = 0.01;
// Share of the speed: a wheel at rest counts nothing.
constexpr double kNoise = 0.02;

/// Standard deviations that the source states, at a speed in m/s: ticks, noise and scale ahead; to
/// the side and up what an uneven ground does.
Eigen::Vector3d stated_sigmas(double speed) {
  const double across = 0.01 + 0.03 * speed;
  return {0.01 + 0.02 * speed, across, across};
}

double initial_scale(uint64_t seed) {
  constexpr uint64_t kOfScale = ~uint64_t{0} >> 2U;
  return 1.0 + kScaleSigma * CounterRandom(seed, RandomStream::wheels).gaussians(kOfScale).x();
}

}  // namespace

Eigen::Isometry3d wheel_mount() {
  Eigen::Isometry3d T_imu_wheels = Eigen::Isometry3d::Identity();
  // Beside the point that follows the route: elsewhere a vehicle that turns drifts to the side.
  T_imu_wheels.translation() = Eigen::Vector3d(0.0, 0.2, -0.5);
  return T_imu_wheels;
}

WheelSimulator::WheelSimulator(int rate, const SplineTrajectory& trajectory,
                               const Eigen::Isometry3d& T_imu_wheels, uint64_t seed)
    : period_(1000000000 / rate),
      trajectory_(&trajectory),
      T_imu_wheels_(T_imu_wheels),
      seed_(seed),
      scale_(initial_scale(seed)) {}

SimulatedWheels WheelSimulator::next() {
  const CounterRandom random(seed_, RandomStream::wheels);
  const double period = 1e-9 * static_cast<double>(period_);
  SimulatedWheels out{.scale = scale_};
  out.velocity.stamp = Nanoseconds(index_ * period_ + period_ / 2);
  out.received = Nanoseconds((index_ + 1) * period_);
  const MotionState state = trajectory_->at(1e-9 * static_cast<double>(out.velocity.stamp.count()));
  const Eigen::Vector3d in_imu = state.T_world_body.linear().transpose() * state.velocity +
                                 state.angular_velocity.cross(T_imu_wheels_.translation());
  out.truth = T_imu_wheels_.linear().transpose() * in_imu;
  const double noise = kNoise * random.gaussians(static_cast<uint64_t>(index_)).x();
  distance_ += (scale_ + noise) * out.truth.x() * period;
  const double ticks = kTick * std::floor(distance_ / kTick + 0.5);
  const double speed = (ticks - counted_) / period;
  counted_ = ticks;
  out.velocity.linear = {speed, 0.0, 0.0};
  out.velocity.covariance = stated_sigmas(std::abs(speed)).cwiseAbs2().asDiagonal().toDenseMatrix();
  ++index_;
  return out;
}

}  // namespace adit
