// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "adit/slam/odometry/motion_model.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

constexpr double kExact = 1e-12;

Vector6d twist(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d xi;
  xi << x, y, z, rx, ry, rz;
  return xi;
}

/// Where a body is that moves with a constant twist (m/s, rad/s) from the identity at time 0.
StampedPose pose_at(const Vector6d& velocity, Nanoseconds stamp) {
  return {stamp, se3_exp(std::chrono::duration<double>(stamp).count() * velocity)};
}

// 0.1 s, with z up: the floor holds z, a wall x, and nothing, or little, holds y.
TEST(HardlyMoves, CountsWhatMatchesHold) {
  RegistrationResult alignment;
  for (int k = 0; k < 3; ++k) {
    alignment.translation.at(static_cast<size_t>(k)) = {.axis = Eigen::Vector3d::Unit(k),
                                                        .localizability = Localizability::full};
  }
  // Turned by 90 degrees: the map's x is the sensor's -y.
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto moved = [&](const Eigen::Vector3d& velocity_lidar) {
    StampedPose from{milliseconds(1000)};
    from.pose.linear() = turned;
    StampedPose to = from;
    to.stamp += milliseconds(100);
    to.pose.translation() = turned * (0.1 * velocity_lidar);
    return hardly_moves(alignment, from, to);
  };
  EXPECT_TRUE(moved({0.3, 0.3, 0.0}));
  EXPECT_FALSE(moved({0.0, 0.6, 0.0}));
  alignment.translation[1].localizability = Localizability::partial;
  EXPECT_TRUE(moved({0.0, 0.9, 0.0}));
  EXPECT_FALSE(moved({0.0, 1.1, 0.0}));
  EXPECT_FALSE(moved({0.6, 0.0, 0.0}));
  alignment.translation[1].localizability = Localizability::none;
  EXPECT_TRUE(moved({0.0, 7.0, 0.0}));
  EXPECT_FALSE(moved({0.0, 7.0, 0.6}));
}

/// A model that has seen a start and aligned sweeps at these times, in ms.
MotionModel model_of(const Vector6d& velocity, std::initializer_list<int> times) {
  MotionModel model;
  bool first = true;
  for (const int time : times) {
    const StampedPose pose = pose_at(velocity, milliseconds(time));
    if (first) {
      model.restart(pose);
    } else {
      model.update(pose, true);
    }
    first = false;
  }
  return model;
}

void expect_near(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double bound) {
  EXPECT_LE((a.matrix() - b.matrix()).norm(), bound) << a.matrix() << "\n\n" << b.matrix();
}

double off_rotation(const Eigen::Isometry3d& pose) {
  return (pose.linear().transpose() * pose.linear() - Eigen::Matrix3d::Identity()).norm();
}

const Vector6d kTurning = twist(14.0, 0.3, -0.2, 0.05, -0.02, 0.6);

TEST(MotionModel, BeforeAnySweepTheIdentityIsPredictedAndNotTrusted) {
  const Prediction prediction = MotionModel().predict(milliseconds(1'000'000));
  expect_near(prediction.T_map_lidar, Eigen::Isometry3d::Identity(), 0.0);
  EXPECT_FALSE(prediction.trusted);
}

TEST(MotionModel, AfterOneSweepTheSensorIsExpectedToStayAndThatIsNotTrusted) {
  const StampedPose start{milliseconds(0), se3_exp(twist(3.0, -1.0, 0.5, 0.2, 0.1, -1.0))};
  MotionModel model;
  model.restart(start);
  const Prediction prediction = model.predict(milliseconds(100));
  expect_near(prediction.T_map_lidar, start.pose, kExact);
  EXPECT_FALSE(prediction.trusted);
}

TEST(MotionModel, ASensorAtRestIsPredictedAtRest) {
  const MotionModel model = model_of(Vector6d::Zero(), {0, 100, 200, 300});
  const Prediction prediction = model.predict(milliseconds(400));
  expect_near(prediction.T_map_lidar, Eigen::Isometry3d::Identity(), kExact);
  EXPECT_TRUE(prediction.trusted);
}

TEST(MotionModel, AConstantTwistIsPredictedExactly) {
  const MotionModel model = model_of(kTurning, {0, 100, 200});
  const Prediction prediction = model.predict(milliseconds(300));
  expect_near(prediction.T_map_lidar, pose_at(kTurning, milliseconds(300)).pose, 1e-9);
  EXPECT_TRUE(prediction.trusted);
}

TEST(MotionModel, ADroppedSweepScalesTheMotionByTheTimeThatPassed) {
  // Sweep 3 is missing: twice the motion, then once again.
  MotionModel model = model_of(kTurning, {0, 100, 200});
  expect_near(model.predict(milliseconds(400)).T_map_lidar,
              pose_at(kTurning, milliseconds(400)).pose, 1e-9);
  model.update(pose_at(kTurning, milliseconds(400)), true);
  expect_near(model.predict(milliseconds(500)).T_map_lidar,
              pose_at(kTurning, milliseconds(500)).pose, 1e-9);
}

TEST(MotionModel, UnevenStampsDoNotChangeTheVelocity) {
  const MotionModel model = model_of(kTurning, {0, 110, 195, 310});
  expect_near(model.predict(milliseconds(400)).T_map_lidar,
              pose_at(kTurning, milliseconds(400)).pose, 1e-9);
}

TEST(MotionModel, TheVelocityIsTrustedOnceTwoSweepsInARowShowedIt) {
  EXPECT_FALSE(model_of(kTurning, {0, 100}).predict(milliseconds(200)).trusted);
  EXPECT_TRUE(model_of(kTurning, {0, 100, 200}).predict(milliseconds(300)).trusted);
}

TEST(MotionModel, AFailureIsBridgedButNotTrusted) {
  MotionModel model = model_of(kTurning, {0, 100, 200, 300});
  const Prediction bridge = model.predict(milliseconds(400));
  model.update({milliseconds(400), bridge.T_map_lidar}, false);
  const Prediction next = model.predict(milliseconds(500));
  EXPECT_FALSE(next.trusted);
  expect_near(next.T_map_lidar, pose_at(kTurning, milliseconds(500)).pose, 1e-9);

  model.update(pose_at(kTurning, milliseconds(500)), true);
  EXPECT_FALSE(model.predict(milliseconds(600)).trusted) << "one success after a failure";
  model.update(pose_at(kTurning, milliseconds(600)), true);
  EXPECT_TRUE(model.predict(milliseconds(700)).trusted) << "two successes after a failure";
}

TEST(MotionModel, ARestartTakesTrustAway) {
  MotionModel model = model_of(kTurning, {0, 100, 200, 300});
  model.restart(pose_at(kTurning, milliseconds(400)));
  EXPECT_FALSE(model.predict(milliseconds(500)).trusted);
  model.update(pose_at(kTurning, milliseconds(500)), true);
  EXPECT_FALSE(model.predict(milliseconds(600)).trusted);
}

TEST(MotionModel, NoMotionIsExtrapolatedBeyondASecondNorTrustedThen) {
  const MotionModel model = model_of(kTurning, {0, 100, 200});
  const Eigen::Isometry3d after_one_second = pose_at(kTurning, milliseconds(1200)).pose;
  const Prediction at_the_bound = model.predict(milliseconds(1200));
  EXPECT_TRUE(at_the_bound.trusted);
  expect_near(at_the_bound.T_map_lidar, after_one_second, 1e-9);
  for (const int time : {1201, 5000, 3'600'000}) {
    const Prediction late = model.predict(milliseconds(time));
    EXPECT_FALSE(late.trusted) << time << " ms";
    expect_near(late.T_map_lidar, after_one_second, 1e-9);
  }
}

TEST(MotionModel, TimeThatGoesBackwardsMovesNothingAndIsNotTrusted) {
  const MotionModel model = model_of(kTurning, {0, 100, 200});
  for (const int time : {199, 0, -3'600'000}) {
    const Prediction back = model.predict(milliseconds(time));
    EXPECT_FALSE(back.trusted) << time << " ms";
    expect_near(back.T_map_lidar, pose_at(kTurning, milliseconds(200)).pose, 1e-9);
  }
}

TEST(MotionModel, ASecondSweepAtTheSameTimeKeepsTheVelocity) {
  MotionModel model = model_of(kTurning, {0, 100, 200});
  model.update(pose_at(kTurning, milliseconds(200)), true);
  expect_near(model.predict(milliseconds(300)).T_map_lidar,
              pose_at(kTurning, milliseconds(300)).pose, 1e-9);
}

// A product of rotations such as R1 R2^T R1 multiplies its distance from SO(3) by 1 + sqrt(2) each
// time: predictions made of predictions leave it within 40 sweeps unless they are brought back.
TEST(MotionModel, PredictionsOfPredictionsStayRigidForTenThousandSweeps) {
  MotionModel model = model_of(kTurning, {0, 100, 200});
  Eigen::Isometry3d last = pose_at(kTurning, milliseconds(200)).pose;
  for (int i = 3; i < 10'003; ++i) {
    const Prediction prediction = model.predict(milliseconds(100 * i));
    ASSERT_LE(off_rotation(prediction.T_map_lidar), 1e-14) << "sweep " << i;
    const Eigen::Isometry3d step = last.inverse() * prediction.T_map_lidar;
    ASSERT_LE((se3_log(step) - 0.1 * kTurning).norm(), 1e-6) << "sweep " << i;
    last = prediction.T_map_lidar;
    model.update({milliseconds(100 * i), last}, true);
  }
}

}  // namespace
}  // namespace adit
