// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/doppler_velocity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace adit {
namespace {

constexpr double kNoise = 0.05;  // m/s

/// A turn of 0.1 s of a sensor with that velocity and acceleration, whose every `each`-th point is
/// of something that walks past.
Sweep turn(const Eigen::Vector3d& velocity,
           const Eigen::Vector3d& acceleration = Eigen::Vector3d::Zero(), int each = 0,
           int points = 6000) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal(0.0, kNoise);
  std::uniform_real_distribution<double> range(2.0, 40.0);
  Sweep sweep;
  sweep.stamp = std::chrono::seconds(3);
  for (int i = 0; i < points; ++i) {
    const double share = static_cast<double>(i) / points;
    const double azimuth = 2.0 * M_PI * share;
    const double elevation = 0.25 * std::sin(0.37 * i);
    const Eigen::Vector3d d(std::cos(azimuth) * std::cos(elevation),
                            std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    const double r = range(random);
    const double time = 0.1 * share;
    const bool moves = each > 0 && i % each == 0;
    const Eigen::Vector3d own =
        moves ? Eigen::Vector3d(0.0, 0.0, 3.0) + 2.0 * d : Eigen::Vector3d(Eigen::Vector3d::Zero());
    const Eigen::Vector3d v = velocity + (time - 0.05) * acceleration;
    sweep.points.push_back({static_cast<float>(r * d.x()), static_cast<float>(r * d.y()),
                            static_cast<float>(r * d.z()), 1.0F});
    sweep.times.push_back(static_cast<float>(time));
    sweep.doppler.push_back(static_cast<float>(d.dot(own - v) + normal(random)));
  }
  return sweep;
}

TEST(DopplerVelocity, IsTheSensorsAtTheMiddleOfTheSweep) {
  const Eigen::Vector3d velocity(8.0, -0.5, 0.2);
  const auto fit = fit_doppler(turn(velocity, {3.0, 6.0, 0.0}));
  ASSERT_TRUE(fit);
  EXPECT_LE((fit->velocity.linear - velocity).norm(), 0.02);
  EXPECT_NEAR(static_cast<double>(fit->velocity.stamp.count()), 3.05e9, 1e5);
  ASSERT_TRUE(fit->velocity.covariance);
  EXPECT_LE(fit->velocity.covariance->diagonal().maxCoeff(), 0.04 * 0.04);
  EXPECT_TRUE(fit->moving.empty()) << fit->moving.size();
}

TEST(DopplerVelocity, WhatMovesIsNamedAndDoesNotCount) {
  const Eigen::Vector3d velocity(1.5, 0.3, 0.0);
  const auto fit = fit_doppler(turn(velocity, Eigen::Vector3d::Zero(), 5));
  ASSERT_TRUE(fit);
  EXPECT_LE((fit->velocity.linear - velocity).norm(), 0.03);
  EXPECT_EQ(fit->moving.size(), 6000U / 5U);
  for (const std::size_t i : fit->moving) {
    EXPECT_EQ(i % 5, 0U);
  }
}

TEST(DopplerVelocity, ADirectionThatNoPointShowsIsNotKnown) {
  Sweep ahead = turn({2.0, 0.0, 0.0});
  for (std::size_t i = 0; i < ahead.points.size(); ++i) {
    ahead.points[i] = {10.0F, 0.0F, 0.0F, 0.0F};
    ahead.doppler[i] = -2.0F;
  }
  const auto fit = fit_doppler(ahead);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->velocity.linear.x(), 2.0, 0.01);
  EXPECT_GE((*fit->velocity.covariance)(1, 1), 1e4) << "nothing is known across the beam";
}

TEST(DopplerVelocity, WithoutSpeedsThereIsNone) {
  Sweep sweep = turn({2.0, 0.0, 0.0});
  sweep.doppler.pop_back();
  EXPECT_FALSE(fit_doppler(sweep)) << "one speed a point, or none";
  sweep.doppler.clear();
  EXPECT_FALSE(fit_doppler(sweep));
  sweep = turn({2.0, 0.0, 0.0});
  std::ranges::fill(sweep.doppler, std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(fit_doppler(sweep));
  EXPECT_FALSE(fit_doppler(turn({2.0, 0.0, 0.0}, Eigen::Vector3d::Zero(), 0, 10)));
}

}  // namespace
}  // namespace adit
