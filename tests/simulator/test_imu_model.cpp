// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/imu_model.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

/// Integrates readings from the true start, by the mean of neighbouring ones. Returns how far the
/// end is off (m, rad).
std::pair<double, double> integration_error(int rate, double duration) {
  const Scene scene = make_room(1);
  const SplineTrajectory motion = make_trajectory(scene, motion_named("handheld"), duration + 1.0);
  ImuSimulator imu(imu_named("perfect"), rate, motion, 1);
  SimulatedImu last = imu.next();
  Eigen::Matrix3d rotation = last.truth.T_world_body.linear();
  Vector3d position = last.truth.T_world_body.translation();
  Vector3d velocity = last.truth.velocity;
  const Vector3d gravity(0.0, 0.0, -kStandardGravity);
  const double dt = 1.0 / rate;
  const int count = static_cast<int>(duration * rate);
  for (int i = 0; i < count; ++i) {
    const SimulatedImu now = imu.next();
    const Vector3d turn = 0.5 * dt * (last.sample.angular_velocity + now.sample.angular_velocity);
    const Eigen::Matrix3d next = rotation * so3_exp(turn);
    const Vector3d before = rotation * last.sample.linear_acceleration + gravity;
    const Vector3d after = next * now.sample.linear_acceleration + gravity;
    position += dt * velocity + dt * dt * (before / 3.0 + after / 6.0);
    velocity += 0.5 * dt * (before + after);
    rotation = next;
    last = now;
  }
  return {(position - last.truth.T_world_body.translation()).norm(),
          rotation_angle(rotation.transpose() * last.truth.T_world_body.linear())};
}

TEST(ImuModel, ReadingsIntegratedFromTheTrueStartReproduceAMinuteOfMotion) {
  const auto [coarse_m, coarse_rad] = integration_error(200, 60.0);
  const auto [fine_m, fine_rad] = integration_error(1000, 60.0);
  RecordProperty("error_m_200_hz", std::to_string(coarse_m));
  RecordProperty("error_m_1000_hz", std::to_string(fine_m));
  std::printf("after 60 s: %.5f m, %.2e rad at 200 Hz; %.5f m, %.2e rad at 1000 Hz\n", coarse_m,
              coarse_rad, fine_m, fine_rad);
  EXPECT_LT(coarse_m, 0.1);
  EXPECT_LT(coarse_rad, 5e-5);
  EXPECT_LT(fine_m, 0.004);
  EXPECT_LT(fine_rad, 2e-6);
}

TEST(ImuModel, AtRestItFeelsGravityAlone) {
  const SplineTrajectory rest{1.0,
                              std::vector<Eigen::Isometry3d>(4, Eigen::Isometry3d::Identity())};
  ImuSimulator imu(imu_named("perfect"), 100, rest, 1);
  const SimulatedImu reading = imu.next();
  EXPECT_EQ(reading.sample.linear_acceleration, Vector3d(0.0, 0.0, kStandardGravity));
  EXPECT_EQ(reading.sample.angular_velocity, Vector3d::Zero());
  EXPECT_EQ(imu.next().sample.stamp, Nanoseconds(10000000));
}

/// Overlapping Allan deviation at `factor` samples.
double allan_deviation(const std::vector<double>& values, std::size_t factor) {
  std::vector<double> sums{0.0};
  for (const double value : values) {
    sums.push_back(sums.back() + value);
  }
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i + 2 * factor < sums.size(); ++i) {
    const double difference = sums[i + 2 * factor] - 2.0 * sums[i + factor] + sums[i];
    squares += difference * difference;
    ++count;
  }
  return std::sqrt(0.5 * squares / static_cast<double>(count)) / static_cast<double>(factor);
}

/// Root mean square of the three axes' Allan deviations of a gyroscope at rest.
class AllanCurve {
 public:
  AllanCurve(const AllanParameters& allan, int rate, double duration) : rate_(rate) {
    const SplineTrajectory rest{1.0,
                                std::vector<Eigen::Isometry3d>(4, Eigen::Isometry3d::Identity())};
    ImuSimulator imu({.name = "test", .gyroscope = {.allan = allan}, .accelerometer = {}}, rate,
                     rest, 11);
    for (int i = 0; i < static_cast<int>(duration * rate); ++i) {
      const SimulatedImu reading = imu.next();
      for (int axis = 0; axis < 3; ++axis) {
        axes_[static_cast<std::size_t>(axis)].push_back(reading.sample.angular_velocity[axis]);
      }
    }
  }

  double at(double tau) const {
    double squares = 0.0;
    for (const std::vector<double>& axis : axes_) {
      const double deviation =
          allan_deviation(axis, static_cast<std::size_t>(std::lround(tau * rate_)));
      squares += deviation * deviation / 3.0;
    }
    return std::sqrt(squares);
  }

 private:
  int rate_;
  std::array<std::vector<double>, 3> axes_;
};

TEST(ImuModel, WhiteNoiseHasItsAllanDeviation) {
  const AllanCurve curve({.white = 2e-3}, 100, 1800.0);
  for (const double tau : {0.05, 0.2, 1.0, 5.0}) {
    EXPECT_NEAR(curve.at(tau) * std::sqrt(tau), 2e-3, 0.05 * 2e-3) << tau;
  }
}

TEST(ImuModel, BiasInstabilityIsAFloorOfTwoThirdsOfIt) {
  const AllanCurve curve({.instability = 1e-3}, 20, 20000.0);
  for (const double tau : {1.0, 3.0, 10.0, 30.0}) {
    EXPECT_NEAR(curve.at(tau), 0.664e-3, 0.1 * 0.664e-3) << tau;
  }
}

TEST(ImuModel, RandomWalkHasItsAllanDeviation) {
  const AllanCurve curve({.walk = 1e-3}, 20, 20000.0);
  for (const double tau : {1.0, 10.0, 40.0}) {
    EXPECT_NEAR(curve.at(tau) / std::sqrt(tau / 3.0), 1e-3, 0.1 * 1e-3) << tau;
  }
}

TEST(ImuModel, AllOfThemTogetherAddUp) {
  const AllanParameters allan{.white = 1e-3, .instability = 5e-4, .walk = 1e-4};
  const AllanCurve curve(allan, 50, 10000.0);
  for (const double tau : {0.1, 1.0, 4.0, 20.0}) {
    const double expected = std::sqrt(1e-6 / tau + std::pow(0.664 * 5e-4, 2) + 1e-8 * tau / 3.0);
    EXPECT_NEAR(curve.at(tau), expected, 0.1 * expected) << tau;
  }
}

TEST(ImuModel, ReadingsAreCutAtTheFullScale) {
  const Scene scene = make_room(1);
  const SplineTrajectory motion = make_trajectory(scene, motion_named("handheld"), 10.0);
  ImuModel model = imu_named("perfect");
  model.gyroscope.full_scale = 0.5;
  ImuSimulator imu(model, 100, motion, 1);
  double largest = 0.0;
  double largest_truth = 0.0;
  for (int i = 0; i < 900; ++i) {
    const SimulatedImu reading = imu.next();
    largest = std::max(largest, reading.sample.angular_velocity.cwiseAbs().maxCoeff());
    largest_truth = std::max(largest_truth, reading.truth.angular_velocity.cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(largest, 0.5);
  EXPECT_GT(largest_truth, 1.0);
}

TEST(ImuModel, NamesThatDoNotExistAreRefused) {
  for (const std::string& name : imu_names()) {
    EXPECT_EQ(imu_named(name).name, name);
  }
  EXPECT_THROW(imu_named("industral"), UsageError);
}

}  // namespace
}  // namespace adit
