// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/velocity_factor.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "adit/tests/support/numerical_jacobian.hpp"
#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

const Eigen::Vector3d kNoBias = Eigen::Vector3d::Zero();
const Eigen::Isometry3d kSensor = test::turned_mounting();  // T_body_sensor

/// What a sensor at kSensor reads at that time.
BodyVelocity velocity_at(const test::WavyMotion& motion, double time) {
  const NavState state = motion.state(time);
  const Eigen::Vector3d rate = motion.sample(time).angular_velocity;
  const Eigen::Vector3d of_body = state.T_map_body.linear().transpose() * state.v_map_body;
  return {.stamp = test::at_seconds(time),
          .linear = kSensor.linear().transpose() *
                    (of_body + rate.cross(Eigen::Vector3d(kSensor.translation())))};
}

VelocityBuffer velocities(const test::WavyMotion& motion, double begin, double end) {
  VelocityBuffer buffer;
  for (double time = begin; time <= end; time += 0.02) {
    buffer.add(velocity_at(motion, time));
  }
  return buffer;
}

TEST(MeasuredDisplacement, IsTheSensorsOwn) {
  const test::WavyMotion motion = test::hand_held_motion();
  const VelocityBuffer buffer = velocities(motion, 0.0, 1.0);
  for (const double begin : {0.1, 0.33, 0.7}) {
    const auto way = measured_displacement(
        buffer, test::readings(motion, begin, begin + 0.1, 200.0), kNoBias, kSensor, 0.05);
    ASSERT_TRUE(way);
    const LinkFactor<3> factor =
        velocity_factor(*way, motion.state(begin), motion.state(begin + 0.1));
    EXPECT_LE(factor.residual.norm() * 0.05 * 0.1, 4e-4)
        << "m, at " << begin << ": 20 ms between velocities cost as much at 2 rad/s";
    EXPECT_NEAR(way->duration, 0.1, 1e-6);
    EXPECT_NEAR(way->covariance.trace(), 3.0 * 0.05 * 0.05 * 0.1 * 0.1, 1e-8);
  }
}

TEST(MeasuredDisplacement, IsUnknownWhereVelocitiesAreFarApart) {
  const test::WavyMotion motion = test::hand_held_motion();
  const auto readings = test::readings(motion, 0.4, 0.6, 200.0);
  VelocityBuffer buffer;
  EXPECT_FALSE(measured_displacement(buffer, readings, kNoBias, kSensor, 0.05));
  EXPECT_TRUE(buffer.add(velocity_at(motion, 0.3)));
  EXPECT_FALSE(measured_displacement(buffer, readings, kNoBias, kSensor, 0.05))
      << "it is old at the end";
  EXPECT_TRUE(buffer.add(velocity_at(motion, 0.8)));
  EXPECT_FALSE(measured_displacement(buffer, readings, kNoBias, kSensor, 0.05))
      << "half a second is too far";
  EXPECT_FALSE(buffer.add(velocity_at(motion, 0.5))) << "it comes too late";
  EXPECT_TRUE(
      measured_displacement(velocities(motion, 0.3, 0.7), readings, kNoBias, kSensor, 0.05));
}

TEST(MeasuredDisplacement, AnAxisThatIsNotMeasuredHoldsNothing) {
  const test::WavyMotion motion = test::hand_held_motion();
  VelocityBuffer buffer;
  for (double time = 0.0; time <= 0.5; time += 0.02) {
    BodyVelocity velocity = velocity_at(motion, time);
    velocity.linear[2] = std::numeric_limits<double>::quiet_NaN();
    buffer.add(velocity);
  }
  const auto way = measured_displacement(buffer, test::readings(motion, 0.2, 0.3, 200.0), kNoBias,
                                         kSensor, 0.05);
  ASSERT_TRUE(way && way->way.allFinite());
  NavState to = motion.state(0.3);
  const double at_it = velocity_factor(*way, motion.state(0.2), to).residual.norm();
  to.T_map_body.translation() +=
      motion.state(0.2).T_map_body.linear() * kSensor.linear() * Eigen::Vector3d(0.0, 0.0, 1.0);
  EXPECT_NEAR(velocity_factor(*way, motion.state(0.2), to).residual.norm(), at_it, 2.0);
  to.T_map_body.translation() +=
      motion.state(0.2).T_map_body.linear() * kSensor.linear() * Eigen::Vector3d(1.0, 0.0, 0.0);
  EXPECT_GT(velocity_factor(*way, motion.state(0.2), to).residual.norm(), 10.0);
}

TEST(VelocityFactor, JacobiansEqualNumericalDifferentiation) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  const test::WavyMotion motion = test::hand_held_motion();
  const VelocityBuffer buffer = velocities(motion, 0.0, 3.0);
  for (int run = 0; run < 20; ++run) {
    const double begin = 0.1 * run + 0.1;
    auto way = measured_displacement(buffer, test::readings(motion, begin, begin + 0.1, 200.0),
                                     kNoBias, kSensor, 0.05);
    ASSERT_TRUE(way);
    way->source = run % 4 == 0 ? VelocitySource::doppler : VelocitySource::sensor;
    const auto off = [&] {
      return StateVector(0.1 * StateVector::NullaryExpr([&] { return normal(engine); }));
    };
    const NavState from = retract(motion.state(begin), off());
    const NavState to = retract(motion.state(begin + 0.1), off());
    const LinkFactor<3> factor = velocity_factor(*way, from, to);
    const auto by_from = test::numerical_jacobian<3, kStateSize>(
        [&](const StateVector& d) { return velocity_factor(*way, retract(from, d), to).residual; });
    const auto by_to = test::numerical_jacobian<3, kStateSize>(
        [&](const StateVector& d) { return velocity_factor(*way, from, retract(to, d)).residual; });
    EXPECT_LE((factor.by_from - by_from).norm(), 1e-6 * by_from.norm());
    EXPECT_LE((factor.by_to - by_to).norm(), 1e-6 * by_to.norm());
  }
}

TEST(VelocityFactor, SlipEndsWithoutWeight) {
  LinkFactor<3> factor;
  EXPECT_EQ(velocity_kernel(factor).weight, 1.0);
  factor.residual.setConstant(100.0);
  EXPECT_LE(velocity_kernel(factor).weight * factor.residual.norm(), 0.05);
}

}  // namespace
}  // namespace adit
