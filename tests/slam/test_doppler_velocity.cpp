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

/// A radar's scan: few points, ahead alone, some of which are ghosts.
TEST(DopplerVelocity, FewPointsWithGhostsGiveTheVelocity) {
  const Eigen::Vector3d velocity(1.2, -0.3, 0.1);
  double squared = 0.0;
  constexpr int kScans = 200;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  for (int k = 0; k < kScans; ++k) {
    Sweep scan;
    for (int i = 0; i < 40; ++i) {
      Eigen::Vector3d d(1.0, 1.2 * even(random), 0.5 * even(random));
      d.normalize();
      const bool ghost = i % 3 == 0;
      const double speed = ghost ? 3.0 * even(random) : -d.dot(velocity) + 0.05 * normal(random);
      scan.points.push_back({static_cast<float>(8.0 * d.x()), static_cast<float>(8.0 * d.y()),
                             static_cast<float>(8.0 * d.z()), 0.0F});
      scan.doppler.push_back(static_cast<float>(speed));
    }
    const auto fit = fit_doppler(scan);
    ASSERT_TRUE(fit) << k;
    const Eigen::Vector3d error = fit->velocity.linear - velocity;
    EXPECT_LE(error.norm(), 0.3) << k;
    squared += error.dot(fit->velocity.covariance->ldlt().solve(error)) / 3.0;
  }
  EXPECT_LE(squared / kScans, 1.5) << "errors are as large as promised";
  EXPECT_GE(squared / kScans, 0.2);
}

TEST(DopplerVelocity, WhereHalfOfThePointsDisagreeThereIsNone) {
  Sweep sweep = turn({2.0, 0.0, 0.0}, Eigen::Vector3d::Zero(), 0, 60);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<float> even(-8.0F, 8.0F);
  std::ranges::generate(sweep.doppler, [&] { return even(random); });
  EXPECT_FALSE(fit_doppler(sweep));
}

TEST(DopplerVelocity, TwoSensorsGiveTheTurningRate) {
  const Eigen::Vector3d velocity(9.0, 0.1, 0.0);
  const Eigen::Vector3d turning(0.0, 0.0, 0.2);
  const std::vector<Eigen::Vector3d> origins = {{2.0, 0.5, 0.0}, {-2.4, 0.0, 0.0}};
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.05);
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  Sweep sweep;
  for (int i = 0; i < 60; ++i) {
    const std::size_t sensor = i % 2 == 0 ? 0 : 1;
    Eigen::Vector3d d(sensor == 0 ? 1.0 : -1.0, even(random), 0.0);
    d.normalize();
    const Eigen::Vector3d p = origins[sensor] + 30.0 * d;
    const Eigen::Vector3d own = velocity + turning.cross(origins[sensor]);
    sweep.points.push_back(
        {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0.0F});
    sweep.rings.push_back(static_cast<uint16_t>(sensor));
    sweep.doppler.push_back(static_cast<float>(-d.dot(own) + normal(random)));
  }
  const auto fit = fit_doppler(sweep, origins);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->twist.rate[5], 0.2, 0.03);
  EXPECT_LE((fit->twist.rate.head<2>() - velocity.head<2>()).norm(), 0.1);
  EXPECT_LE(std::sqrt(fit->twist.covariance(5, 5)), 0.1);
  EXPECT_GE(std::sqrt(fit->twist.covariance(5, 5)), 0.02) << "mountings err by half a degree";
  EXPECT_GE(std::sqrt(fit_doppler(sweep)->twist.covariance(5, 5)), 0.9) << "one sensor: unknown";
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
