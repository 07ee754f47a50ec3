// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/sensor_start.hpp"

#include <chrono>
#include <cmath>
#include <variant>

#include <gtest/gtest.h>

#include "adit/tests/support/numerical_jacobian.hpp"
#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

constexpr ImuNoise kSensorNoise{.gyro = 5e-4, .accel = 5e-3, .gyro_walk = 1e-5, .accel_walk = 1e-4};
constexpr double kSensorRate = 200.0;

/// Ten sweeps a second of a motion, with the readings between them.
StartCollection collected(const test::WavyMotion& motion, int sweeps, double accel_scale = 1.0) {
  StartCollection result;
  for (int i = 0; i < sweeps; ++i) {
    const double time = 0.1 * i;
    const NavState state = motion.state(time);
    auto since = i == 0 ? std::nullopt
                        : std::optional(with_accel_scale(
                              test::readings(motion, time - 0.1, time, kSensorRate), accel_scale));
    result.add({state.stamp, state.T_map_body}, std::move(since));
  }
  return result;
}

/// The same readings as the tracker keeps them.
InertialReadings kept(const test::WavyMotion& motion, double end) {
  InertialReadings readings{ImuConfig{}};
  for (const ImuSample& sample : test::readings(motion, -0.1, end, kSensorRate)) {
    readings.add(sample);
  }
  return readings;
}

test::WavyMotion at_rest() {
  return {.position = {}, .angles = {{{0.2, 0.0, M_PI_2, 0.0}, {}, {}}}};
}

// Free of everything but a constant force, turned out of the map's axes, so that every term counts.
TEST(VelocityAfter, IsThatOfAConstantAcceleration) {
  const double t = 0.4;
  const Eigen::Vector3d gravity(1.0, -2.0, -9.5);
  const Eigen::Vector3d acceleration(0.7, 0.4, -1.1);
  const Eigen::Vector3d begin(3.0, -2.0, 0.5);  // m/s
  Eigen::Isometry3d first(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  first.translation() << 10.0, 20.0, 30.0;
  Eigen::Isometry3d second = first;
  second.translation() += t * begin + 0.5 * t * t * acceleration;
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 40; ++i) {
    samples.push_back(
        {.stamp = test::at_seconds(0.01 * i),
         .angular_velocity = Eigen::Vector3d::Zero(),
         .linear_acceleration = first.linear().transpose() * (acceleration - gravity)});
  }
  const Preintegration between = preintegrate(samples, {}, kSensorNoise);
  ASSERT_NEAR(between.duration, t, 1e-12);
  const Eigen::Vector3d expected = begin + t * acceleration;
  EXPECT_LE((velocity_after(first, second, between, gravity) - expected).norm(), 1e-9);
}

TEST(VelocityAfter, IsThatOfAHandThatWavesTheSensor) {
  const test::WavyMotion motion = test::hand_held_motion();
  for (int i = 0; i < 20; ++i) {
    const double time = 0.13 * i;
    const NavState first = motion.state(time);
    const NavState second = motion.state(time + 0.1);
    const Preintegration between =
        preintegrate(test::readings(motion, time, time + 0.1, kSensorRate), {}, kSensorNoise);
    const Eigen::Vector3d found =
        velocity_after(first.T_map_body, second.T_map_body, between, motion.gravity);
    EXPECT_LE((found - second.v_map_body).norm(), 2e-3) << time;
  }
}

TEST(StartAfterGap, GravityBiasesAndUnitAreThoseFromBefore) {
  const test::WavyMotion motion = test::hand_held_motion();
  FusedBefore before{.state = motion.state(0.0), .accel_scale = kStandardGravity};
  const StartCollection two = collected(motion, 2, 1.0 / kStandardGravity);
  const SensorStart start = start_after_gap(two, kSensorNoise, before);
  EXPECT_EQ(start.state.stamp, test::at_seconds(0.1));
  EXPECT_LE((start.state.v_map_body - motion.state(0.1).v_map_body).norm(), 2e-3);
  EXPECT_EQ(start.state.gravity_map, before.state.gravity_map);
  EXPECT_EQ(start.how.accel_scale, kStandardGravity);
  EXPECT_TRUE(std::holds_alternative<StartedAfterGap>(start.how.reason));
  EXPECT_NEAR(start.how.velocity_sigma, 0.3, 1e-9);
  const StatePrior prior = prior_of(start);
  EXPECT_NEAR(prior.root(kVelocityAt, kVelocityAt), 1.0 / 0.3, 1e-6);
  EXPECT_NEAR(prior.root(kGyroBiasAt, kGyroBiasAt), 1.0 / 0.005, 1e-6);
}

TEST(RestFactor, JacobianIsThatOfDifferences) {
  const NavState state = test::hand_held_motion().state(0.4);
  const Eigen::Vector3d reading(0.7, -0.4, 9.6);
  const auto residual = [&](const StateVector& delta) {
    return rest_factor(reading, retract(state, delta), 0.02).residual;
  };
  const Eigen::Matrix<double, 3, kStateSize> numerical =
      test::numerical_jacobian<3, kStateSize>(residual);
  EXPECT_LE((rest_factor(reading, state, 0.02).by_state - numerical).norm(),
            1e-7 * numerical.norm());
}

// A tilt and a bias are each unknown, and what they do together is known to a centimetre per second
// and second.
TEST(PriorOfAStart, AtRestTiltAndBiasAreKnownTogether) {
  const test::WavyMotion motion = at_rest();
  const auto attempt =
      try_start(collected(motion, 11), kept(motion, 1.1), kSensorNoise, std::nullopt);
  const auto* start = std::get_if<SensorStart>(&attempt);
  ASSERT_NE(start, nullptr);
  const StatePrior prior = prior_of(*start);
  EXPECT_TRUE(prior.offset.isZero(1e-9));
  const StateMatrix covariance = (prior.root.transpose() * prior.root).inverse();
  const StateFactor<3> rest =
      rest_factor(start->state.bias.accel -
                      start->state.T_map_body.linear().transpose() * start->state.gravity_map,
                  start->state, 1.0);
  EXPECT_LE(rest.residual.norm(), 1e-9);
  const Eigen::Matrix3d together = rest.by_state * covariance * rest.by_state.transpose();
  EXPECT_LE(std::sqrt(together(0, 0)), 0.02);
  EXPECT_LE(std::sqrt(together(1, 1)), 0.02);
  EXPECT_GE(std::sqrt(covariance(kAccelBiasAt, kAccelBiasAt)), 0.06);
  EXPECT_GE(std::sqrt(covariance(kGravityAt, kGravityAt)), 0.006);
}

TEST(StartCollection, KeepsTheNewestInARow) {
  StartCollection collection;
  for (int i = 0; i < 30; ++i) {
    collection.add({test::at_seconds(0.1 * i), Eigen::Isometry3d::Identity()},
                   i == 0 ? std::nullopt : std::optional(std::vector<ImuSample>(3)));
  }
  EXPECT_EQ(collection.poses().size(), 24U);
  EXPECT_EQ(collection.readings().size(), 23U);
  EXPECT_EQ(collection.poses().back().stamp, test::at_seconds(2.9));
  collection.add({test::at_seconds(5.0), Eigen::Isometry3d::Identity()}, std::nullopt);
  EXPECT_EQ(collection.poses().size(), 1U) << "what is missing in between ends the row";
  EXPECT_TRUE(collection.readings().empty());
  collection.add({test::at_seconds(5.1), Eigen::Isometry3d::Identity()}, std::vector<ImuSample>(3));
  EXPECT_EQ(collection.readings().size(), 1U);
}

TEST(TryStart, NeedsASecond) {
  const test::WavyMotion motion = at_rest();
  const auto attempt =
      try_start(collected(motion, 10), kept(motion, 1.0), kSensorNoise, std::nullopt);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(attempt));
}

TEST(TryStart, AtRestWhereTheSweepsAre) {
  const test::WavyMotion motion = at_rest();
  const auto attempt =
      try_start(collected(motion, 11), kept(motion, 1.1), kSensorNoise, std::nullopt);
  const auto* start = std::get_if<SensorStart>(&attempt);
  ASSERT_NE(start, nullptr);
  EXPECT_EQ(start->how.status, ImuStartStatus::at_rest);
  EXPECT_EQ(start->state.stamp, test::at_seconds(1.0));
  EXPECT_LE((start->state.gravity_map - motion.gravity).norm(), 1e-6);
  EXPECT_TRUE(start->state.v_map_body.isZero());
}

TEST(TryStart, InMotionWhereTheyAreNot) {
  const test::WavyMotion motion = test::hand_held_motion();
  const auto attempt =
      try_start(collected(motion, 16), kept(motion, 1.6), kSensorNoise, std::nullopt);
  const auto* start = std::get_if<SensorStart>(&attempt);
  ASSERT_NE(start, nullptr);
  EXPECT_EQ(start->how.status, ImuStartStatus::in_motion);
  EXPECT_LE((start->state.v_map_body - motion.state(1.5).v_map_body).norm(), 0.05);
}

TEST(TryStart, AnotherUnitThanBeforeIsInTheWayUnlessItsSignWasAssumed) {
  const test::WavyMotion motion = test::hand_held_motion();
  FusedBefore before{.state = motion.state(0.0), .accel_scale = -1.0};
  const auto with = [&] {
    return try_start(collected(motion, 16), kept(motion, 1.6), kSensorNoise, before);
  };
  const auto hindered = with();
  const auto* hindrance = std::get_if<InertialHindrance>(&hindered);
  ASSERT_NE(hindrance, nullptr);
  EXPECT_TRUE(std::holds_alternative<UnitChanged>(*hindrance));
  before.sign_assumed = true;
  EXPECT_TRUE(std::holds_alternative<SensorStart>(with()));
  before.accel_scale = kStandardGravity;
  EXPECT_TRUE(std::holds_alternative<InertialHindrance>(with())) << "no sign makes up for a unit";
}

// The poses swing the other way, by a third: the opposite sign fits better, and may be chance.
TEST(TryStart, AfterAFailedCheckASignThatIsNotClearIsWaitedFor) {
  const auto swing = [](double amplitude) {
    return test::WavyMotion{.position = {{{}, {amplitude, 0.6, 0.0, 0.0}, {}}},
                            .angles = {{{}, {0.2, 0.3, 0.0, 0.0}, {}}}};
  };
  StartCollection waiting;
  const StartCollection told = collected(swing(0.5), 16);
  const StartCollection seen = collected(swing(-0.15), 16);
  for (size_t i = 0; i < seen.poses().size(); ++i) {
    waiting.add(seen.poses()[i], i == 0 ? std::nullopt : std::optional(told.readings()[i - 1]), {});
  }
  const auto with = [&](std::optional<FusedBefore> before) {
    return try_start(waiting, kept(swing(0.5), 1.6), kSensorNoise, before);
  };
  EXPECT_TRUE(std::holds_alternative<SensorStart>(with(std::nullopt)));
  FusedBefore before{.state = swing(0.5).state(0.0)};
  EXPECT_TRUE(std::holds_alternative<SensorStart>(with(before)));
  before.sign_assumed = true;
  const auto hindered = with(before);
  const auto* hindrance = std::get_if<InertialHindrance>(&hindered);
  ASSERT_NE(hindrance, nullptr);
  EXPECT_TRUE(std::holds_alternative<SignUnclear>(*hindrance));
}

TEST(TryStart, ARefusalIsToldWithItsReason) {
  const test::WavyMotion motion = test::hand_held_motion();
  const auto attempt =
      try_start(collected(motion, 16, 0.4), kept(motion, 1.6), kSensorNoise, std::nullopt);
  const auto* hindrance = std::get_if<InertialHindrance>(&attempt);
  ASSERT_NE(hindrance, nullptr);
  const auto* reason = std::get_if<ImuStartReason>(hindrance);
  ASSERT_NE(reason, nullptr);
  EXPECT_TRUE(std::holds_alternative<NoGravityInMotion>(*reason));
}

}  // namespace
}  // namespace adit
