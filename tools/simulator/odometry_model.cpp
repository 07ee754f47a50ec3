// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/odometry_model.hpp"

#include <cmath>

#include "adit/tools/simulator/counter_random.hpp"

namespace adit {
namespace {

constexpr double kInitialScaleSigma = 0.03;
constexpr double kScaleWalk = 0.002;    // of a root second: 1.5 per cent in a minute
constexpr double kWayNoise = 0.02;      // of the way between two pictures, on each axis
constexpr double kPixelNoise = 0.0005;  // m a picture, at rest, too
constexpr double kTurnNoise = 0.0003;   // rad a picture

/// By arithmetic that has the same result on any machine.
Eigen::Matrix3d small_turn(const Eigen::Vector3d& turn) {
  const Eigen::Vector3d half = 0.5 * turn;
  return Eigen::Quaterniond(1.0, half.x(), half.y(), half.z()).normalized().toRotationMatrix();
}

}  // namespace

Eigen::Isometry3d camera_mount() {
  Eigen::Isometry3d T_imu_camera = Eigen::Isometry3d::Identity();
  T_imu_camera.translation() = Eigen::Vector3d(0.15, 0.02, -0.03);
  return T_imu_camera;
}

OdometrySimulator::OdometrySimulator(int rate, const SplineTrajectory& trajectory,
                                     const Eigen::Isometry3d& T_imu_camera, uint64_t seed)
    : period_(1000000000 / rate),
      trajectory_(&trajectory),
      T_imu_camera_(T_imu_camera),
      seed_(seed),
      scale_(1.0 + kInitialScaleSigma *
                       CounterRandom(seed, RandomStream::odometry).gaussian_vector(0).x()) {}

ReferencePose OdometrySimulator::next() {
  const CounterRandom random(seed_, RandomStream::odometry);
  const auto at = [&](int64_t index) {
    return trajectory_->pose(1e-9 * static_cast<double>(index * period_)) * T_imu_camera_;
  };
  if (index_ > 0) {
    const auto number = static_cast<uint64_t>(3 * index_);
    const Eigen::Isometry3d step = at(index_ - 1).inverse() * at(index_);
    scale_ += kScaleWalk * std::sqrt(1e-9 * static_cast<double>(period_)) *
              random.gaussian_vector(number).x();
    const double noise = kPixelNoise + kWayNoise * step.translation().norm();
    Eigen::Isometry3d seen = step;
    seen.translation() = scale_ * step.translation() + noise * random.gaussian_vector(number + 1);
    seen.linear() *= small_turn(kTurnNoise * random.gaussian_vector(number + 2));
    T_start_camera_ = T_start_camera_ * seen;
  }
  const Nanoseconds stamp(index_ * period_);
  ++index_;
  return {.stamp = stamp,
          .parent = "visual_odometry",
          .child = "camera",
          .T_parent_child = T_start_camera_};
}

}  // namespace adit
