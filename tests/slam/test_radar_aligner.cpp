// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/radar_aligner.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace adit {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// What a radar at a pose sees of walls: `corridor` has two along x alone, else there are ends.
Sweep scan_from(const Isometry3d& T_map_lidar, std::mt19937_64& random, bool corridor = false) {
  std::uniform_real_distribution<double> along(-25.0, 25.0);
  std::uniform_real_distribution<double> up(-1.0, 2.0);
  std::uniform_real_distribution<double> kind(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  Sweep scan;
  for (int i = 0; i < 300; ++i) {
    const double x = along(random) + (corridor ? T_map_lidar.translation().x() : 0.0);
    const double side = kind(random) < 0.5 ? -6.0 : 6.0;
    const bool on_end = !corridor && kind(random) < 0.4;
    const Vector3d wall = on_end ? Vector3d(kind(random) < 0.5 ? -25.0 : 25.0, 0.24 * x, up(random))
                                 : Vector3d(x, side, up(random));
    Vector3d p = T_map_lidar.inverse() * wall;
    const double range = p.norm() + 0.1 * normal(random);
    Vector3d direction = p.normalized();
    direction += 0.017 * Vector3d(normal(random), normal(random), normal(random));
    p = range * direction.normalized();
    if (kind(random) < 0.05) {
      p *= 1.2 + kind(random);  // a ghost
    }
    scan.points.push_back(
        {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 1.0F});
    scan.doppler.push_back(0.0F);
  }
  return scan;
}

Isometry3d at(double x, double y, double yaw) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(x, y, 0.0);
  pose.linear() = so3_exp({0.0, 0.0, yaw});
  return pose;
}

/// One that has seen a drive of 6 m.
RadarAligner driven(std::mt19937_64& random, bool corridor = false) {
  RadarAligner aligner{PreprocessConfig{}};
  for (int i = 0; i < 30; ++i) {
    const Isometry3d pose = at(-6.0 + 0.2 * i, 0.0, 0.0);
    aligner.add(scan_from(pose, random, corridor), pose);
  }
  return aligner;
}

/// The last scans, and the next one, were taken elsewhere than it is believed: at `off` times the
/// truth.
void drift(RadarAligner& aligner, const Isometry3d& off, std::mt19937_64& random,
           bool corridor = false) {
  for (int i = 0; i < 3; ++i) {
    const Isometry3d pose = at(0.05 * i, 0.0, 0.0);
    aligner.add(scan_from(pose, random, corridor), off * pose);
  }
}

Prediction vague(const Isometry3d& pose) {
  Prediction prediction{.T_map_lidar = pose, .trusted = true, .moving = true};
  prediction.sigma << Vector3d::Constant(0.5), Vector3d::Constant(0.05);
  return prediction;
}

TEST(RadarAligner, FindsThePoseWithinWhatItPromises) {
  double squared = 0.0;
  constexpr int kRuns = 20;
  for (uint64_t seed = 1; seed <= kRuns; ++seed) {
    std::mt19937_64 random(seed);
    RadarAligner aligner = driven(random);
    const Isometry3d off = at(0.2, 0.1, 0.02);
    drift(aligner, off, random);
    const Isometry3d truth = at(0.15, 0.0, 0.0);
    const RegistrationResult found =
        aligner.align(scan_from(truth, random), vague(off * truth), true);
    ASSERT_TRUE(is_usable(found.status)) << seed;
    const Vector6d error = se3_log(truth.inverse() * found.T_target_source);
    EXPECT_LE(error.head<2>().norm(), 0.25) << seed;
    EXPECT_LE(std::abs(error[5]), 0.02) << seed;
    squared += error.dot(radar_covariance(found).ldlt().solve(error)) / 6.0;
  }
  EXPECT_LE(squared / kRuns, 2.0) << "errors are as large as promised";
  EXPECT_GE(squared / kRuns, 0.05) << "and not much smaller";
}

TEST(RadarAligner, WhatNoReturnHoldsStaysPredicted) {
  std::mt19937_64 random(5);
  RadarAligner aligner = driven(random, true);
  const Isometry3d off = at(0.5, 0.2, 0.0);
  drift(aligner, off, random, true);
  const Isometry3d truth = at(0.15, 0.0, 0.0);
  const Prediction prediction = vague(off * truth);
  const RegistrationResult found = aligner.align(scan_from(truth, random, true), prediction, true);
  EXPECT_EQ(found.status, RegistrationStatus::degenerate);
  EXPECT_EQ(found.translation[0].localizability, Localizability::none);
  EXPECT_NEAR(found.T_target_source.translation().x(), 0.65, 0.1) << "along the corridor";
  EXPECT_NEAR(found.T_target_source.translation().y(), 0.0, 0.1) << "across it";
  EXPECT_EQ(aligner.align(scan_from(truth, random, true), prediction, false).status,
            RegistrationStatus::too_little_overlap)
      << "nothing measured the motion either";
}

TEST(RadarAligner, AnEmptyScanOrMapIsThePrediction) {
  std::mt19937_64 random(7);
  RadarAligner aligner{PreprocessConfig{}};
  const Prediction prediction = vague(at(1.0, 0.0, 0.1));
  RegistrationResult found = aligner.align(scan_from(at(1, 0, 0), random), prediction, true);
  EXPECT_TRUE(is_usable(found.status));
  EXPECT_TRUE(found.T_target_source.isApprox(prediction.T_map_lidar));
  EXPECT_TRUE(found.information.isZero());
  aligner = driven(random);
  Sweep empty;
  empty.points = {{}, {std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F, 0.0F}};
  found = aligner.align(empty, prediction, false);
  EXPECT_EQ(found.status, RegistrationStatus::too_few_points);
}

TEST(RadarAligner, FarReturnsKnowLittleAcrossTheBeam) {
  std::mt19937_64 random(9);
  const RadarAligner aligner = driven(random);
  const RegistrationResult found =
      aligner.align(scan_from(at(0, 0, 0), random), vague(at(0, 0, 0)), true);
  const double along = found.information(0, 0);
  const double height = found.information(2, 2);
  EXPECT_GT(along, 0.0);
  EXPECT_LT(height, along) << "walls hold no height";
}

TEST(RadarAligner, FewPointsWithSpeedsAreARadars) {
  std::mt19937_64 random(1);
  Sweep scan = scan_from(at(0, 0, 0), random);
  EXPECT_TRUE(is_radar_scan(scan));
  Sweep lidar;
  lidar.points.resize(20000, Point{.x = 1.0F});
  lidar.doppler.resize(20000, 0.0F);
  EXPECT_FALSE(is_radar_scan(lidar));
  scan.doppler.clear();
  EXPECT_FALSE(is_radar_scan(scan));
}

}  // namespace
}  // namespace adit
