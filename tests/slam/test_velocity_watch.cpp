// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a sensor of velocities counts with while it slips.
#include "adit/slam/fusion/velocity_watch.hpp"

#include <functional>
#include <random>

#include <gtest/gtest.h>

namespace adit {
namespace {

constexpr double kBetweenSweeps = 0.1;  // s
constexpr double kReadingSigma = 0.02;  // m/s, of a reading
constexpr double kPriorOfScale = 0.05;

/// A body that goes along x at 2 m/s, whose velocity and scale the prediction knows well; `error`
/// of the n-th sweep is added to what is read.
struct StraightDrive {
  VelocityWatch watch{kPriorOfScale};
  std::mt19937_64 random{11};

  VelocityReport step(const Eigen::Vector3d& error, double speed = 2.0) {
    std::normal_distribution<double> normal(0.0, kReadingSigma);
    NavState from;
    StateEstimate prediction;
    prediction.state.T_map_body.translation().x() = kBetweenSweeps * speed;
    prediction.covariance.diagonal().segment<3>(kVelocityAt).setConstant(0.005 * 0.005);
    prediction.covariance(kScaleAt, kScaleAt) = 0.002 * 0.002;
    const Eigen::Vector3d noise = Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
    MeasuredDisplacement way{
        .way = kBetweenSweeps * (Eigen::Vector3d(speed, 0.0, 0.0) + error + noise),
        .covariance = kBetweenSweeps * kBetweenSweeps * kReadingSigma * kReadingSigma *
                      Eigen::Matrix3d::Identity(),
        .duration = kBetweenSweeps};
    return watch.judge(way, from, prediction);
  }
};

TEST(VelocityWatch, NoiseKeepsWhatItPromises) {
  StraightDrive drive;
  int slips = 0;
  double mean = 0.0;  // of the variance along x, over what is promised
  for (int i = 0; i < 300; ++i) {
    const VelocityReport report = drive.step(Eigen::Vector3d::Zero());
    slips += report.slips ? 1 : 0;
    mean += report.covariance(0, 0) / (kReadingSigma * kReadingSigma) / 300.0;
  }
  EXPECT_LE(slips, 6);
  EXPECT_LT(mean, 1.6);
}

TEST(VelocityWatch, SlipCountsForLittleAlongItselfAlone) {
  StraightDrive drive;
  for (int i = 0; i < 30; ++i) {
    drive.step(Eigen::Vector3d::Zero());
  }
  VelocityReport report;
  for (int i = 0; i < 15; ++i) {
    report = drive.step({0.2, 0.0, 0.0});
    EXPECT_TRUE(report.slips) << i;
    EXPECT_FALSE(report.refused) << i;
  }
  // Fifteen sweeps together know no more than one with an error of 0.2 m/s.
  EXPECT_GT(report.covariance(0, 0), 0.8 * 15.0 * 0.2 * 0.2);
  EXPECT_LT(report.covariance(1, 1), 6.0 * kReadingSigma * kReadingSigma);
  for (int i = 0; i < 25; ++i) {
    report = drive.step(Eigen::Vector3d::Zero());
  }
  EXPECT_FALSE(report.slips);
  EXPECT_LT(report.covariance(0, 0), 6.0 * kReadingSigma * kReadingSigma);
}

TEST(VelocityWatch, AtRestAnEarlierSlipDoesNotCount) {
  StraightDrive drive;
  for (int i = 0; i < 30; ++i) {
    drive.step(Eigen::Vector3d(i < 20 ? 0.0 : 0.2, 0.0, 0.0));
  }
  const VelocityReport report = drive.step(Eigen::Vector3d::Zero(), 0.0);
  EXPECT_FALSE(report.slips);
}

}  // namespace
}  // namespace adit
