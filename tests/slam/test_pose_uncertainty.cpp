// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/pose_uncertainty.hpp"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace adit {
namespace {

Eigen::Isometry3d ahead(double distance, double turn = 0.0) {
  Vector6d xi;
  xi << distance, 0.0, 0.0, 0.0, 0.0, turn;
  return se3_exp(xi);
}

Matrix6d of_sigma(double translation, double rotation) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(rotation * rotation);
  return variance.asDiagonal();
}

TEST(PoseUncertainty, TheMapDoesNotDriftWhileItsFirstCloudsHoldIt) {
  DriftModel model(5);
  const Matrix6d local = of_sigma(0.01, 0.001);
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(model.update(ahead(1.0 * i), local, true).drift.isZero());
  }
  EXPECT_TRUE(model.update(ahead(5.0), local, true).drift.isZero());
  const PoseUncertainty first = model.update(ahead(6.0), local, false);
  const PoseUncertainty stays = model.update(ahead(6.0), local, false);
  EXPECT_GT(first.drift.trace(), 0.0);
  EXPECT_TRUE(stays.drift.isApprox(first.drift));
  EXPECT_TRUE(stays.in_map().isApprox(stays.drift + local));
}

TEST(PoseUncertainty, AnAttitudeThatDriftedMovesWhatIsFarAhead) {
  DriftModel model(0);
  model.update(ahead(0.0), of_sigma(0.0, 0.01), true);
  const Matrix6d there = model.update(ahead(100.0), Matrix6d::Zero(), false).drift;
  EXPECT_NEAR(there(1, 1), 1e4 * there(5, 5), 1e-9);
  EXPECT_NEAR(there(0, 0), 0.0, 1e-12);
}

// A submap that moves by a random error whenever a cloud joins, and sweeps that err in it: both
// covariances against the errors of many such walks.
TEST(PoseUncertainty, MotionsOfRandomWalksAreAsUncertainAsTold) {
  constexpr int kRuns = 2000;
  constexpr double kKept = 0.15;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const Matrix6d local = of_sigma(0.01, 0.002);
  const auto error = [&](double share) {
    return Vector6d(std::sqrt(share) * Vector6d(local.diagonal().cwiseSqrt().cwiseProduct(
                                           Vector6d::NullaryExpr([&] { return normal(random); }))));
  };
  double motion = 0.0;
  double map = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    DriftModel model(0);
    Eigen::Isometry3d T_map_world = Eigen::Isometry3d::Identity();
    UncertainPose from;
    UncertainPose to;
    for (int i = 0; i <= 10; ++i) {
      const Eigen::Isometry3d truth = ahead(0.8 * i, 0.1 * i);
      const PoseUncertainty uncertainty = model.update(truth, local, true);
      to = {.T_map_lidar = retract(T_map_world * truth, error(1.0)), .uncertainty = uncertainty};
      from = i == 4 ? to : from;
      T_map_world = retract(T_map_world * truth, error(kKept)) * truth.inverse();
    }
    const auto squared = [](const Eigen::Isometry3d& off, const Matrix6d& covariance) {
      const Vector6d e = se3_log(off);
      return e.dot(covariance.ldlt().solve(e));
    };
    const Eigen::Isometry3d T_from_to = ahead(3.2, 0.4).inverse() * ahead(8.0, 1.0);
    motion += squared(T_from_to.inverse() * from.T_map_lidar.inverse() * to.T_map_lidar,
                      motion_covariance(from, to));
    map += squared(ahead(8.0, 1.0).inverse() * to.T_map_lidar, to.uncertainty.in_map());
  }
  EXPECT_NEAR(motion / kRuns, 6.0, 0.3);
  EXPECT_NEAR(map / kRuns, 6.0, 0.3);
}

TEST(PoseUncertainty, WhatARestartLacksAllAfterItLack) {
  DriftModel model(5);
  model.update(ahead(0.0), of_sigma(0.01, 0.001), true);
  model.update(ahead(1.0), Matrix6d::Zero(), false);
  const PoseUncertainty restarted = model.restart(of_sigma(0.5, 0.1));
  EXPECT_TRUE(restarted.local.isZero());
  EXPECT_TRUE(restarted.in_map().isApprox(of_sigma(0.5, 0.1)));
  EXPECT_GE(model.update(ahead(1.0), Matrix6d::Zero(), false).drift(0, 0), 0.25);
}

}  // namespace
}  // namespace adit
