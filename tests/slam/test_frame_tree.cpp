// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/frame_tree.hpp"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

Eigen::Isometry3d at(double x, double yaw = 0.0) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = so3_exp({0.0, 0.0, yaw});
  T.translation().x() = x;
  return T;
}

struct Given {
  const char* parent;
  const char* child;
  Eigen::Isometry3d T;
};

FrameTree tree_of(const std::vector<Given>& transforms) {
  FrameTree tree;
  for (const Given& one : transforms) {
    tree.add({one.parent, one.child, one.T});
  }
  return tree;
}

/// x of lidar in imu; -1000 where nothing connects them.
double x_of_lidar(const FrameTree& tree) {
  const auto T = tree.transform("imu", "lidar");
  return T ? T->translation().x() : -1000.0;
}

TEST(FrameTree, ChainsGoUpAndDownAndNamesHaveNoSlashes) {
  const FrameTree tree = tree_of(
      {{"/base", "imu", at(1.0)}, {"//base", "/mast", at(2.0)}, {"mast", "lidar", at(3.0)}});
  EXPECT_DOUBLE_EQ(x_of_lidar(tree), 4.0);
  EXPECT_TRUE(tree.knows("/lidar"));
  EXPECT_FALSE(tree.transform("imu", "camera"));
  EXPECT_EQ(tree.mounting("/lidar").root, "base");
  EXPECT_TRUE(tree.ignored().empty());
  EXPECT_FALSE(tree.conflict("imu", "lidar"));
}

TEST(FrameTree, OneBadTransformLeavesTheOthers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::Isometry3d scaled = at(0.0);
  scaled.linear() *= 2.0;
  const std::vector<std::pair<Given, TransformFault>> bad = {
      {{"lidar", "lidar", at(0.0)}, TransformFault::itself},
      {{"/lidar", "lidar", at(0.0)}, TransformFault::itself},
      {{"", "lidar", at(0.0)}, TransformFault::unnamed},
      {{"/", "lidar", at(0.0)}, TransformFault::unnamed},
      {{"imu", "", at(0.0)}, TransformFault::unnamed},
      {{"imu", "lidar", at(nan)}, TransformFault::not_finite},
      {{"imu", "lidar", scaled}, TransformFault::not_finite},
      {{"lidar", "imu", at(0.0, 3.1)}, TransformFault::loop},
  };
  for (const auto& [given, fault] : bad) {
    const FrameTree tree = tree_of({{"imu", "lidar", at(1.0)}, given, given});
    EXPECT_DOUBLE_EQ(x_of_lidar(tree), 1.0) << given.parent << " " << given.child;
    ASSERT_EQ(tree.ignored().size(), 1U) << given.parent << " " << given.child;
    EXPECT_EQ(tree.ignored()[0].fault, fault) << given.parent << " " << given.child;
  }
}

TEST(FrameTree, ALoopOfThreeKeepsTheDirectTransform) {
  for (const bool direct_first : {true, false}) {
    std::vector<Given> given = {{"lidar", "base", at(0.0)}, {"base", "imu", at(0.0, 3.1)}};
    given.insert(direct_first ? given.begin() : given.end(), {"imu", "lidar", at(1.0)});
    const FrameTree tree = tree_of(given);
    EXPECT_DOUBLE_EQ(x_of_lidar(tree), 1.0);
    EXPECT_EQ(tree.ignored().size(), 1U);
    const auto conflict = tree.conflict("imu", "lidar");
    ASSERT_TRUE(conflict);
    EXPECT_NEAR(conflict->angle, 3.1, 1e-9);
  }
}

TEST(FrameTree, TheInverseOfATransformIsNoLoop) {
  const FrameTree tree = tree_of({{"imu", "lidar", at(1.0)}, {"lidar", "imu", at(-1.0)}});
  EXPECT_DOUBLE_EQ(x_of_lidar(tree), 1.0);
  EXPECT_TRUE(tree.ignored().empty());
  EXPECT_FALSE(tree.conflict("imu", "lidar"));
}

TEST(FrameTree, ASecondParentHidesNothing) {
  const FrameTree tree =
      tree_of({{"imu", "lidar", at(1.0)}, {"map", "lidar", at(50.0)}, {"body", "imu", at(7.0)}});
  EXPECT_DOUBLE_EQ(x_of_lidar(tree), 1.0);
  EXPECT_TRUE(tree.transform("map", "body"));
  EXPECT_TRUE(tree.ignored().empty());
  EXPECT_FALSE(tree.conflict("imu", "lidar"));
}

TEST(FrameTree, AmongEquallyShortChainsTheLaterParentCounts) {
  const FrameTree tree = tree_of({{"a", "imu", at(0.0)},
                                  {"a", "lidar", at(1.0)},
                                  {"b", "imu", at(0.0)},
                                  {"b", "lidar", at(2.0)}});
  EXPECT_DOUBLE_EQ(x_of_lidar(tree), 2.0);
  const auto conflict = tree.conflict("imu", "lidar");
  ASSERT_TRUE(conflict);
  EXPECT_NEAR(conflict->distance, 1.0, 1e-9);
}

TEST(FrameTree, ALaterTransformOfTheSameFramesReplacesAndAContradictionIsNamed) {
  const FrameTree refined = tree_of({{"imu", "lidar", at(1.0)}, {"imu", "lidar", at(1.001)}});
  EXPECT_DOUBLE_EQ(x_of_lidar(refined), 1.001);
  EXPECT_FALSE(refined.conflict("imu", "lidar")) << "a millimetre is a refined calibration";
  const FrameTree other = tree_of({{"imu", "lidar", at(1.0)}, {"imu", "lidar", at(0.0, 3.1)}});
  EXPECT_DOUBLE_EQ(x_of_lidar(other), 0.0);
  const auto conflict = other.conflict("imu", "lidar");
  ASSERT_TRUE(conflict);
  EXPECT_EQ(conflict->parent + " " + conflict->child, "imu lidar");
  EXPECT_NEAR(conflict->angle, 3.1, 1e-9);
}

TEST(FrameTree, AContradictionCountsForTheFramesThatItConnects) {
  const FrameTree tree = tree_of(
      {{"imu", "lidar", at(1.0)}, {"imu", "camera", at(1.0)}, {"lidar", "camera", at(9.0)}});
  EXPECT_DOUBLE_EQ(x_of_lidar(tree), 1.0);
  EXPECT_TRUE(tree.conflict("imu", "lidar")) << "over the camera it is 8 m elsewhere";
  const FrameTree apart =
      tree_of({{"imu", "lidar", at(1.0)}, {"imu", "camera", at(1.0)}, {"imu", "camera", at(9.0)}});
  EXPECT_FALSE(apart.conflict("imu", "lidar"));
  EXPECT_TRUE(apart.conflict("imu", "camera"));
}

TEST(FrameTree, ALongChainIsWalkedAndMemoryIsBounded) {
  FrameTree tree;
  for (int i = 0; i < 3000; ++i) {
    tree.add({"f" + std::to_string(i), "f" + std::to_string(i + 1), at(1.0)});
  }
  const auto T = tree.transform("f0", "f1000");
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->translation().x(), 1000.0, 1e-6);
  EXPECT_FALSE(tree.knows("f2900"));
}

}  // namespace
}  // namespace adit
