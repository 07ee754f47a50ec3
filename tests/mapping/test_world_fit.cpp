// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/world_fit.hpp"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"

namespace adit {
namespace {

constexpr double kYaw = 2.5;
const Eigen::Vector3d kShift(30.0, -12.0, 4.0);

/// A bent drive of `count` fixes, 2 m apart, each off by white errors of `sigma` (m).
std::vector<PositionPair> drive(std::size_t count, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<PositionPair> pairs;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(kYaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const double heading = 0.02 * static_cast<double>(i);
    p += 2.0 * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
    const Eigen::Vector3d error(noise(random), noise(random), 2.0 * noise(random));
    pairs.push_back(
        {.p_map = p,
         .p_world = turn * p + kShift + error,
         .covariance = sigma * sigma * Eigen::Vector3d(1.0, 1.0, 4.0).asDiagonal().toDenseMatrix(),
         .time = static_cast<double>(i)});
  }
  return pairs;
}

double yaw_error(const WorldFit& fit) {
  return std::abs(
      rotation_angle(fit.T_world_map.linear().transpose() *
                     Eigen::AngleAxisd(kYaw, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
}

TEST(WorldFit, FindsYawAndPlaceAndHowWellItKnowsTheYaw) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const std::vector<PositionPair> pairs = drive(100, 0.5, seed);
    const auto fit = fit_world(pairs, 0.1);
    ASSERT_TRUE(fit);
    EXPECT_LT(yaw_error(*fit), 4.0 * fit->yaw_sigma);
    EXPECT_GT(fit->yaw_sigma, 1e-4);
    EXPECT_LT(fit->yaw_sigma, 0.01);
    EXPECT_LT((fit->T_world_map.translation() - kShift).norm(), 1.5);
    EXPECT_GT(fit->agreeing, 95U);
  }
}

TEST(WorldFit, WhatIsOutsideDoesNotCount) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::vector<PositionPair> pairs = drive(100, 0.02, seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> far(10.0, 50.0);
    for (std::size_t i = 0; i < 100; i += 3) {
      pairs[i].p_world += Eigen::Vector3d(far(random), far(random), 0.0);
    }
    const auto fit = fit_world(pairs, 1.0);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->agreeing, 66U);
    for (std::size_t i = 0; i < 100; ++i) {
      EXPECT_EQ(fit->agrees[i], i % 3 != 0) << i;
    }
    EXPECT_LT(yaw_error(*fit), 1e-3);
  }
}

TEST(WorldFit, KnowsLittleOfAShortWayAndNothingOfNone) {
  const auto fit = fit_world(drive(5, 1.5, 1), 60.0);
  EXPECT_TRUE(!fit || fit->yaw_sigma > 5.0 * kDegree);
  std::vector<PositionPair> standing = drive(20, 1.5, 2);
  for (PositionPair& pair : standing) {
    pair.p_map.setZero();
  }
  EXPECT_FALSE(fit_world(standing, 60.0));
  EXPECT_FALSE(fit_world({}, 60.0));
  EXPECT_FALSE(fit_world(drive(2, 0.1, 3), 60.0));
}

TEST(GnssNoise, ReceiversAreNotBelievedBelowWhatAFixCanHave) {
  GnssFix fix;
  fix.kind = GnssFixKind::ground_augmented;
  fix.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d least = fix_covariance(fix, {});
  EXPECT_NEAR(least(0, 0), 0.02 * 0.02, 1e-9);
  EXPECT_NEAR(least(2, 2), 0.04 * 0.04, 1e-9);
  fix.covariance = Eigen::Vector3d(4.0, 9.0, 16.0).asDiagonal();
  EXPECT_LT((fix_covariance(fix, {}) - *fix.covariance).norm(), 1e-9);
  EXPECT_NEAR(fix_covariance(fix, {.noise_scale = 2.0})(1, 1), 36.0, 1e-9);
  fix.covariance = Eigen::Matrix3d::Zero();
  EXPECT_NEAR(fix_covariance(fix, {})(0, 0), 0.06 * 0.06, 1e-9);
  fix.covariance.reset();
  EXPECT_NEAR(fix_covariance(fix, {})(0, 0), 0.06 * 0.06, 1e-9);
}

TEST(GnssNoise, SharesOfAStretchAddUpToWhatItHasOfIndependentFixes) {
  std::vector<double> times;
  for (int i = 0; i <= 100; ++i) {
    times.push_back(0.6 * i);
  }
  const std::vector<double> shares = independent_shares(times, 10.0);
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0 + 60.0 / 20.0, 1e-9);
  const std::vector<double> apart =
      independent_shares(std::vector<double>{0.0, 100.0, 200.0}, 10.0);
  for (const double share : apart) {
    EXPECT_NEAR(share, 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace adit
