// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/keyframe_edge.hpp"

#include <chrono>

#include <gtest/gtest.h>

#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

Matrix6d covariance_of(double metres, double radians) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(metres), Eigen::Vector3d::Constant(radians);
  return sigma.cwiseAbs2().asDiagonal();
}

KeyframeMotion motion(double x, double metres, double radians) {
  return {.T_from_to = test::step(x, 0.1 * x),
          .covariance = covariance_of(metres, radians),
          .lasting = covariance_of(metres, radians)};
}

TEST(KeyframeEdge, AnOdometryThatDoesNotDriftIsHardlyMoved) {
  KeyframeMotion odometry = motion(1.0, 0.02, 0.002);
  odometry.lasting.setZero();
  const KeyframeMotion both = combined(odometry, motion(1.1, 0.01, 0.001));
  EXPECT_NEAR(both.T_from_to.translation().x(), 1.0, 0.1 * 0.02);
  // Known as well as both together, counted by half: 1/(0.5 (1/2^2 + 1/1^2)) cm^2.
  EXPECT_NEAR(both.covariance(0, 0), 1.6e-4, 0.05e-4);
}

TEST(KeyframeEdge, AnOdometryThatDriftsIsPutRightButWhereTheAlignmentHoldsNothing) {
  KeyframeMotion aligned = motion(1.1, 0.01, 0.001);
  aligned.T_from_to.translation() = Eigen::Vector3d(1.1, 0.1, 0.1);
  aligned.covariance(0, 0) = aligned.lasting(0, 0) = 100.0;  // a tunnel along x
  const KeyframeMotion odometry{.T_from_to = test::step(1.0),
                                .covariance = covariance_of(0.1, 0.1),
                                .lasting = covariance_of(0.5, 0.5)};
  const KeyframeMotion both = combined(odometry, aligned);
  EXPECT_NEAR(both.T_from_to.translation().x(), 1.0, 0.01);
  EXPECT_NEAR(both.T_from_to.translation().y(), 0.1, 0.01);
  EXPECT_NEAR(both.T_from_to.translation().z(), 0.1, 0.01);
  EXPECT_NEAR(so3_log(both.T_from_to.linear()).z(), 0.11, 0.001);
  EXPECT_NEAR(both.covariance(0, 0), 2.0 * 0.01, 0.001) << "the odometry's, counted by half";
}

TEST(KeyframeEdge, OfTheOdometryTheDriftLasts) {
  const UncertainPose from{Nanoseconds(0),
                           test::step(0.0),
                           {.local = covariance_of(0.01, 0.001), .drift = covariance_of(0.1, 0.0)}};
  const UncertainPose to{
      std::chrono::seconds(100),
      test::step(1.0),
      {.local = covariance_of(0.02, 0.001), .drift = covariance_of(std::hypot(0.1, 0.005), 0.0)}};
  const KeyframeMotion odometry =
      odometry_motion(from, to, test::step(1.0), Eigen::Isometry3d::Identity());
  EXPECT_NEAR(odometry.lasting(0, 0), 0.005 * 0.005, 1e-12);
  EXPECT_NEAR(odometry.covariance(0, 0), 0.005 * 0.005 + 0.01 * 0.01 + 0.02 * 0.02, 1e-12);
  // A keyframe whose axes are turned by 90 degrees about z, and a covariance along x alone.
  UncertainPose along = to;
  along.uncertainty.local.setZero();
  along.uncertainty.local(0, 0) = 1.0;
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.rotate(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()));
  const Matrix6d turned = odometry_motion(from, along, test::step(1.0), turn).covariance;
  EXPECT_NEAR(turned(1, 1) - turned(0, 0), 1.0, 1e-5);
}

TEST(KeyframeEdge, AnEdgeHasTheInformationOfItsMotion) {
  const PoseEdge edge = edge_of(3, 4, motion(1.0, 0.02, 0.002));
  EXPECT_EQ(edge.from, 3);
  EXPECT_EQ(edge.to, 4);
  EXPECT_EQ(edge.kind, EdgeKind::odometry);
  EXPECT_NEAR(edge.information(0, 0), 1.0 / (0.02 * 0.02 + 1e-6), 1e-6);
  EXPECT_EQ(edge.information, edge.information.transpose());
}

}  // namespace
}  // namespace adit
