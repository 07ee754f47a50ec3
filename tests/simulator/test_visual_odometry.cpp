// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/odometry_model.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/simulator/faults.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/scene.hpp"

namespace adit {
namespace {

TEST(VisualOdometry, ItsScaleIsOffAndDriftsAndItsTurnsAreRight) {
  const SplineTrajectory trajectory =
      make_trajectory(make_scene("mine", 1), motion_named("drive"), 12.0);
  double squares = 0.0;
  constexpr int kSeeds = 20;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    OdometrySimulator odometry(20, trajectory, camera_mount(), seed);
    ReferencePose last = odometry.next();
    EXPECT_TRUE(last.T_parent_child.isApprox(Eigen::Isometry3d::Identity()));
    double way = 0.0;
    double true_way = 0.0;
    for (int i = 1; i < 200; ++i) {
      const ReferencePose next = odometry.next();
      EXPECT_EQ(next.stamp, std::chrono::milliseconds(50 * i));
      const auto at = [&](const ReferencePose& pose) {
        return trajectory.pose(seconds(pose.stamp)) * camera_mount();
      };
      const Eigen::Isometry3d step = last.T_parent_child.inverse() * next.T_parent_child;
      const Eigen::Isometry3d true_step = at(last).inverse() * at(next);
      way += step.translation().norm();
      true_way += true_step.translation().norm();
      EXPECT_LT(so3_log(true_step.linear().transpose() * step.linear()).norm(), 0.002);
      last = next;
    }
    const double scale = way / true_way - 1.0;
    EXPECT_LT(std::abs(scale), 0.15);
    squares += scale * scale;
  }
  const double rms = std::sqrt(squares / kSeeds);
  EXPECT_GT(rms, 0.015);
  EXPECT_LT(rms, 0.06);
}

TEST(VisualOdometry, ItLeapsAndIsLostWhereThatIsAsked) {
  const auto at = [](const char* fault, int s) {
    ReferencePose pose;
    pose.stamp = std::chrono::seconds(s);
    pose.T_parent_child.translation().x() = 10.0;
    FaultMaker({fault_named(fault)}, 20.0, 1).distort(pose);
    return Eigen::Vector3d(pose.T_parent_child.translation());
  };
  EXPECT_EQ(at("odometry-leap", 9), Eigen::Vector3d(10.0, 0.0, 0.0));
  EXPECT_EQ((at("odometry-leap", 11) - at("odometry-leap", 9)).norm(), 3.0);
  EXPECT_EQ(at("odometry-lost", 7), Eigen::Vector3d(10.0, 0.0, 0.0));
  EXPECT_EQ(at("odometry-lost", 9), at("odometry-lost", 12));
  EXPECT_EQ(at("odometry-lost", 14), Eigen::Vector3d(10.0, 0.0, 0.0));
}

}  // namespace
}  // namespace adit
