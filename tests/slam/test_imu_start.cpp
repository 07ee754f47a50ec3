// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>
#include <variant>

#include <gtest/gtest.h>

#include "adit/slam/inertial/imu_start.hpp"
#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

using test::WavyMotion;

constexpr ImuNoise kStartNoise{.gyro = 2e-4, .accel = 2e-3, .gyro_walk = 1e-5, .accel_walk = 1e-4};
constexpr double kStartRate = 200.0;
const ImuBias kStartBias{{0.01, -0.03, 0.02}, {0.0, 0.0, 0.0}};

/// Standing still, tilted by 0.2 and -0.3 rad.
std::vector<ImuSample> at_rest(double duration, double accel_scale = 1.0) {
  const WavyMotion motion{.position = {},
                          .angles = {{{0.2, 0.0, M_PI_2, 0.0}, {-0.3, 0.0, M_PI_2, 0.0}, {}}}};
  std::mt19937_64 random(1);
  std::vector<ImuSample> samples = test::readings(motion, 0.0, duration, kStartRate, kStartBias);
  test::add_noise(samples, kStartNoise, kStartRate, random);
  return with_accel_scale(samples, accel_scale);
}

Eigen::Vector3d tilted_up() {
  return (Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()))
             .inverse() *
         Eigen::Vector3d::UnitZ();
}

TEST(ImuStart, AtRestGravityAndGyroBiasAreTheMeans) {
  const ImuStart start = start_at_rest(at_rest(2.0), kStartNoise);
  ASSERT_EQ(start.status, ImuStartStatus::at_rest) << to_string(start.status);
  EXPECT_LE(test::angle_between(start.up_body, tilted_up()), 1e-3);
  EXPECT_LE((start.bias.gyro - kStartBias.gyro).norm(), 1e-3);
  EXPECT_LE((start.bias.gyro - kStartBias.gyro).cwiseAbs().maxCoeff(),
            4.0 * start.bias_sigma.gyro.maxCoeff());
  EXPECT_EQ(start.accel_scale, 1.0);
  const auto& how = std::get<StartedAtRest>(start.reason);
  EXPECT_NEAR(how.duration, 2.0, 0.01);
  EXPECT_FALSE(how.in_g);
}

TEST(ImuStart, WhatGravityIsTooLongOrTooShortByIsABiasOfTheAccelerometer) {
  for (const double scale : {1.02, 0.98}) {
    const ImuStart start = start_at_rest(at_rest(2.0, scale), kStartNoise);
    ASSERT_EQ(start.status, ImuStartStatus::at_rest) << to_string(start.status);
    EXPECT_LE((start.bias.accel - (scale - 1.0) * kStandardGravity * tilted_up()).norm(), 1e-2)
        << scale;
  }
}

TEST(ImuStart, FewSpikesDoNotHideThatItRestsAndManyDo) {
  const ImuStart clean = start_at_rest(at_rest(2.0), kStartNoise);
  ASSERT_EQ(clean.status, ImuStartStatus::at_rest);
  for (const auto& [every, rests] : {std::pair{20, true}, std::pair{5, false}}) {
    std::vector<ImuSample> samples = at_rest(2.0);
    for (std::size_t i = 3; i < samples.size(); i += static_cast<std::size_t>(every)) {
      samples[i].angular_velocity.y() += 7.0;
      samples[i].linear_acceleration.z() -= 60.0;
    }
    const ImuStart start = start_at_rest(samples, kStartNoise);
    EXPECT_EQ(start.status == ImuStartStatus::at_rest, rests) << every;
    if (rests) {
      EXPECT_LT((start.bias.gyro - clean.bias.gyro).norm(), 1e-3);
      EXPECT_LT(test::angle_between(start.up_body, clean.up_body), 1e-3);
    }
  }
}

TEST(ImuStart, AnAccelerometerInGIsUnderstood) {
  const ImuStart start = start_at_rest(at_rest(2.0, 1.0 / kStandardGravity), kStartNoise);
  ASSERT_EQ(start.status, ImuStartStatus::at_rest) << to_string(start.status);
  EXPECT_EQ(start.accel_scale, kStandardGravity);
  EXPECT_LE(test::angle_between(start.up_body, tilted_up()), 1e-3);
  EXPECT_TRUE(std::get<StartedAtRest>(start.reason).in_g);
}

TEST(ImuStart, AnotherUnitIsRefusedWithWhatWasRead) {
  const ImuStart start = start_at_rest(at_rest(2.0, 0.4), kStartNoise);
  EXPECT_EQ(start.status, ImuStartStatus::implausible);
  const auto& found = std::get<NoGravityAtRest>(start.reason);
  EXPECT_NEAR(found.reading, 0.4 * kStandardGravity, 0.01);
  EXPECT_FALSE(found.scale) << "too far off for an error of scale";
}

TEST(ImuStart, AnErrorOfScaleIsToldWithWhatMendsIt) {
  const ImuStart start = start_at_rest(at_rest(2.0, 1.25), kStartNoise);
  EXPECT_EQ(start.status, ImuStartStatus::implausible);
  const auto& found = std::get<NoGravityAtRest>(start.reason);
  ASSERT_TRUE(found.scale);
  EXPECT_NEAR(*found.scale, 0.8, 0.01);
}

TEST(ImuStart, AShortOrMovingStartIsRefusedWithTheReason) {
  EXPECT_EQ(start_at_rest({}, kStartNoise).status, ImuStartStatus::too_short);
  const ImuStart brief = start_at_rest(at_rest(0.3), kStartNoise);
  EXPECT_EQ(brief.status, ImuStartStatus::too_short);
  const auto& few = std::get<TooFewReadings>(brief.reason);
  EXPECT_NEAR(few.duration, 0.3, 0.01);
  EXPECT_GT(few.readings, few.needed);
  EXPECT_EQ(few.needed_duration, 0.5);
  const ImuStart moving =
      start_at_rest(test::readings(test::hand_held_motion(), 0.0, 2.0, kStartRate), kStartNoise);
  EXPECT_EQ(moving.status, ImuStartStatus::not_at_rest);
  const auto& unsteady = std::get<NotAtRest>(moving.reason);
  EXPECT_GT(unsteady.gyro, unsteady.gyro_limit);
  EXPECT_EQ(unsteady.gyro_limit, 0.02);
  EXPECT_EQ(unsteady.accel_limit, 0.3);
}

TEST(ImuStart, ASteadyTurnIsNoBias) {
  const WavyMotion turning{.position = {}, .angles = {{{}, {}, {0.0, 0.0, 0.0, 0.5}}}};
  const ImuStart start = start_at_rest(test::readings(turning, 0.0, 2.0, kStartRate), kStartNoise);
  EXPECT_EQ(start.status, ImuStartStatus::not_at_rest);
  EXPECT_NEAR(std::get<SteadyTurn>(start.reason).rate, 0.5, 1e-3);
}

TEST(ImuStart, ASlowTiltIsNotAtRestThoughItsRatesAreSmall) {
  const WavyMotion tilting{.position = {}, .angles = {{{}, {0.0, 0.0, 0.0, 0.015}, {}}}};
  const ImuStart start = start_at_rest(test::readings(tilting, 0.0, 2.0, kStartRate), kStartNoise);
  EXPECT_EQ(start.status, ImuStartStatus::not_at_rest);
}

TEST(ImuStart, LevelAttitudesTurnUpIntoZAndNothingAboutIt) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 200; ++run) {
    const Eigen::Vector3d up =
        run == 0 ? Eigen::Vector3d(Eigen::Vector3d::UnitX())
                 : Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Eigen::Matrix3d R = level_attitude(up);
    EXPECT_LE((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
    EXPECT_LE((R * up - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
    EXPECT_LE(std::abs(up.x()) > 0.9 ? std::abs(R(0, 1)) : std::abs(R(1, 0)), 1e-12);
  }
  EXPECT_LE((level_attitude(Eigen::Vector3d::UnitZ()) - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

struct StartDrive {
  std::vector<StampedPose> poses;
  std::vector<std::vector<ImuSample>> readings;
};

/// Poses at 10 Hz from `begin` with errors of 1 cm and 2 mrad, and readings with biases between.
StartDrive drive(const WavyMotion& motion, double begin, int poses, double accel_scale,
                 uint64_t seed) {
  const ImuBias bias{{0.01, -0.03, 0.02}, {0.05, -0.02, 0.04}};
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  StartDrive result;
  for (int i = 0; i < poses; ++i) {
    const double t = begin + 0.1 * i;
    Vector6d error = Vector6d::NullaryExpr([&] { return normal(random); });
    error.head<3>() *= 0.01;
    error.tail<3>() *= 0.002;
    result.poses.push_back({test::at_seconds(t), retract(motion.state(t).T_map_body, error)});
    if (i + 1 < poses) {
      std::vector<ImuSample> samples = test::readings(motion, t, t + 0.1, kStartRate, bias);
      test::add_noise(samples, kStartNoise, kStartRate, random);
      result.readings.push_back(with_accel_scale(samples, accel_scale));
    }
  }
  return result;
}

TEST(ImuStart, InMotionGravityVelocityAndGyroBiasAreFound) {
  WavyMotion motion = test::hand_held_motion();
  motion.gravity = kStandardGravity * Eigen::Vector3d(0.1, -0.2, -0.9).normalized();
  double worst_gravity = 0.0;
  double worst_velocity = 0.0;
  double worst_bias = 0.0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const double begin = 0.17 * static_cast<double>(seed);
    const StartDrive d = drive(motion, begin, 16, 1.0, seed);
    const ImuStart start = start_in_motion(d.poses, d.readings, kStartNoise);
    ASSERT_EQ(start.status, ImuStartStatus::in_motion) << to_string(start.status);
    const NavState truth = motion.state(begin + 1.5);
    const double off = test::angle_between(start.gravity_map, motion.gravity);
    EXPECT_LE(off, 4.0 * start.gravity_sigma) << "seed " << seed;
    worst_gravity = std::max(worst_gravity, off);
    worst_velocity = std::max(worst_velocity, (start.v_map_body - truth.v_map_body).norm());
    worst_bias = std::max(worst_bias, (start.bias.gyro - kStartBias.gyro).norm());
    EXPECT_LE(
        test::angle_between(start.up_body, truth.T_map_body.linear().transpose() * -motion.gravity),
        worst_gravity + 0.01);
  }
  EXPECT_LE(worst_gravity, 0.03);
  EXPECT_LE(worst_velocity, 0.15);
  EXPECT_LE(worst_bias, 0.01);
}

// Sweeps that nothing holds along a direction slide there, ever faster as if they fell.
TEST(ImuStart, InMotionPositionsTellNothingAlongWhatNothingHeld) {
  WavyMotion motion = test::hand_held_motion();
  motion.gravity = kStandardGravity * Eigen::Vector3d(0.0, 0.0, -1.0);
  for (uint64_t seed = 0; seed < 10; ++seed) {
    StartDrive d = drive(motion, 0.17 * static_cast<double>(seed), 16, 1.0, seed);
    const auto slid = [](std::size_t i) { return i % 4 != 0; };
    std::vector<std::vector<Eigen::Vector3d>> none(d.poses.size(), {Eigen::Vector3d::UnitX()});
    std::vector<std::vector<Eigen::Vector3d>> some(d.poses.size());
    for (std::size_t i = 0; i < d.poses.size(); ++i) {
      const double t = 0.1 * static_cast<double>(i);
      if (slid(i)) {
        d.poses[i].pose.translation().x() += 1.5 * t * t;
        some[i] = none[i];
      }
    }
    const ImuStart blind = start_in_motion(d.poses, d.readings, kStartNoise, none);
    EXPECT_EQ(blind.status, ImuStartStatus::unobserved) << to_string(blind.status);
    const ImuStart told = start_in_motion(d.poses, d.readings, kStartNoise, some);
    ASSERT_EQ(told.status, ImuStartStatus::in_motion) << to_string(told.status);
    EXPECT_LE(test::angle_between(told.gravity_map, motion.gravity), 4.0 * told.gravity_sigma);
    EXPECT_LE(test::angle_between(told.gravity_map, motion.gravity), 0.05);
    const ImuStart deceived = start_in_motion(d.poses, d.readings, kStartNoise);
    EXPECT_TRUE(deceived.status != ImuStartStatus::in_motion ||
                test::angle_between(deceived.gravity_map, motion.gravity) > 0.05)
        << "it matters";
  }
}

TEST(ImuStart, InMotionTheUnitAndTheSignAreFound) {
  const WavyMotion motion = test::hand_held_motion();
  for (const double expected : {1.0, kStandardGravity, -1.0, -kStandardGravity}) {
    const StartDrive d = drive(motion, 0.4, 16, 1.0 / expected, 7);
    const ImuStart start = start_in_motion(d.poses, d.readings, kStartNoise);
    ASSERT_EQ(start.status, ImuStartStatus::in_motion) << to_string(start.status);
    EXPECT_EQ(start.accel_scale, expected);
    const auto& how = std::get<StartedInMotion>(start.reason);
    EXPECT_EQ(how.poses, 16U);
    EXPECT_EQ(how.in_g, std::abs(expected) != 1.0);
    EXPECT_EQ(how.negative, expected < 0.0);
    EXPECT_EQ(how.usual_error >= kClearlyBetter, how.negative);
    EXPECT_TRUE(is_sign_told(start)) << start.other_sign_error;
    EXPECT_LE(test::angle_between(start.gravity_map, motion.gravity), 0.03)
        << to_string(start.status);
  }
}

// Poses that swing by `share` of what the readings say, so that the sign they speak for is known,
// and how clearly: the usual one leaves (1 - share)^2 of the swing, the opposite one (1 + share)^2.
TEST(ImuStart, InMotionTheOppositeSignWantsClearProof) {
  const auto swing = [](double amplitude) {
    return WavyMotion{.position = {{{0.0, 0.0, 0.0, 1.0}, {amplitude, 0.6, 0.0, 0.0}, {}}},
                      .angles = {{{}, {0.2, 0.3, 0.0, 0.0}, {}}}};
  };
  struct Case {
    double share;
    double accel_scale;
    bool told;
    bool other_fits_better;
  };
  for (const Case& one : {Case{1.0, 1.0, true, false}, Case{0.3, 1.0, false, false},
                          Case{-0.3, 1.0, false, true}, Case{-1.0, -1.0, true, false}}) {
    for (uint64_t seed = 0; seed < 10; ++seed) {
      StartDrive d = drive(swing(0.5), 0.0, 16, 1.0, seed);
      d.poses = drive(swing(0.5 * one.share), 0.0, 16, 1.0, seed).poses;
      const ImuStart start = start_in_motion(d.poses, d.readings, kStartNoise);
      ASSERT_EQ(start.status, ImuStartStatus::in_motion) << to_string(start.status);
      EXPECT_EQ(start.accel_scale, one.accel_scale) << one.share << ", seed " << seed;
      EXPECT_EQ(is_sign_told(start), one.told) << one.share << ": " << start.other_sign_error;
      EXPECT_EQ(start.other_sign_error < 1.0, one.other_fits_better)
          << one.share << ": " << start.other_sign_error;
    }
  }
}

TEST(ImuStart, InMotionAWrongUnitIsRefused) {
  const StartDrive d = drive(test::hand_held_motion(), 0.4, 16, 0.4, 7);
  const ImuStart start = start_in_motion(d.poses, d.readings, kStartNoise);
  EXPECT_EQ(start.status, ImuStartStatus::implausible) << to_string(start.status);
  EXPECT_NEAR(std::get<NoGravityInMotion>(start.reason).gravity, 0.4 * kStandardGravity, 0.5);
}

TEST(ImuStart, FewPosesAreTooShort) {
  const StartDrive d = drive(test::hand_held_motion(), 0.4, 4, 1.0, 7);
  const ImuStart start = start_in_motion(d.poses, d.readings, kStartNoise);
  EXPECT_EQ(start.status, ImuStartStatus::too_short);
  EXPECT_EQ(std::get<TooFewPoses>(start.reason).poses, 4U);
  EXPECT_EQ(std::get<TooFewPoses>(start.reason).needed, 6U);
}

}  // namespace
}  // namespace adit
