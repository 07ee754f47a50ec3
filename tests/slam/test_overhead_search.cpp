// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/overhead_search.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

constexpr double kSearchStep = 0.5;  // m

/// Ground of 60 x 60 m at z = -1.8 and walls on it that no turn or shift brings upon each other.
std::vector<Eigen::Vector3d> yard() {
  std::vector<Eigen::Vector3d> points;
  for (double x = -30.0; x < 30.0; x += 0.5) {
    for (double y = -30.0; y < 30.0; y += 0.5) {
      points.emplace_back(x, y, -1.8);
    }
  }
  const auto wall = [&](double x, double y, double dx, double dy, double height) {
    for (double along = 0.0; along <= 1.0; along += 0.02) {
      for (double z = -1.8; z < height; z += 0.4) {
        points.emplace_back(x + along * dx, y + along * dy, z);
      }
    }
  };
  wall(-20.0, 12.0, 14.0, 3.0, 4.0);
  wall(8.0, -15.0, 2.0, 11.0, 3.0);
  wall(15.0, 10.0, -6.0, 6.0, 2.0);
  wall(-12.0, -18.0, 9.0, 0.0, 5.0);
  return points;
}

/// The points as they look from T_a_b, where b has them.
std::vector<Point> seen_from(const std::vector<Eigen::Vector3d>& points,
                             const Eigen::Isometry3d& T_a_b) {
  std::vector<Point> seen;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3f q = (T_a_b.inverse() * p).cast<float>();
    seen.push_back({q.x(), q.y(), q.z(), 0.0F});
  }
  return seen;
}

Eigen::Isometry3d flat_pose(double x, double y, double z, double degrees) {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(degrees * kDegree, Eigen::Vector3d::UnitZ()));
  pose.translation() << x, y, z;
  return pose;
}

TEST(OverheadSearch, FindsEveryHeadingAndShiftWithinWhatAnAlignmentForgives) {
  const std::vector<Eigen::Vector3d> points = yard();
  const OverheadView a =
      overhead_view(seen_from(points, Eigen::Isometry3d::Identity()), kSearchStep);
  Random random(3);
  for (int i = 0; i < 12; ++i) {
    const Eigen::Isometry3d truth =
        flat_pose(random.uniform(-15.0, 15.0), random.uniform(-15.0, 15.0),
                  random.uniform(-3.0, 3.0), random.uniform(-180.0, 180.0));
    const std::vector<Eigen::Isometry3d> found =
        find_overhead_poses(a, overhead_view(seen_from(points, truth), kSearchStep));
    ASSERT_FALSE(found.empty());
    const Eigen::Isometry3d off = truth.inverse() * found.front();
    EXPECT_LT(off.translation().norm(), 1.5) << i;
    EXPECT_LT(rotation_angle(off.linear()), 5.0 * kDegree) << i;
  }
}

TEST(OverheadSearch, GivesDifferentPosesAndNoMoreThanAsked) {
  const std::vector<Point> points = seen_from(yard(), Eigen::Isometry3d::Identity());
  const OverheadView view = overhead_view(points, kSearchStep);
  const std::vector<Eigen::Isometry3d> found =
      find_overhead_poses(view, view, {.most_poses = 5, .turn = 5.0, .least_apart = 2.0});
  ASSERT_EQ(found.size(), 5U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Isometry3d off = found[i].inverse() * found[j];
      EXPECT_TRUE(off.translation().norm() >= 2.0 || rotation_angle(off.linear()) >= 12.0 * kDegree)
          << i << ", " << j;
    }
  }
}

TEST(OverheadSearch, WhereNothingRisesThereIsNothingToFind) {
  std::vector<Point> ground;
  for (int i = 0; i < 1000; ++i) {
    ground.push_back({static_cast<float>(i % 40), static_cast<float>(i / 40), -1.8F, 0.0F});
  }
  const OverheadView flat = overhead_view(ground, kSearchStep);
  const OverheadView walls =
      overhead_view(seen_from(yard(), Eigen::Isometry3d::Identity()), kSearchStep);
  EXPECT_TRUE(find_overhead_poses(flat, walls).empty());
  EXPECT_TRUE(find_overhead_poses(walls, flat).empty());
  EXPECT_TRUE(find_overhead_poses(overhead_view({}, kSearchStep), walls).empty());
}

TEST(OverheadSearch, LeavesOutWhatIsNoReturn) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  const std::vector<Point> points = {{nan, 1.0F, 1.0F, 0.0F},   {1.0F, infinite, 1.0F, 0.0F},
                                     {1.0F, 1.0F, 1e30F, 0.0F}, {0.0F, 0.0F, 0.0F, 0.0F},
                                     {1.2F, 1.3F, 0.1F, 0.0F},  {1.3F, 1.2F, 0.9F, 0.0F},
                                     {1.3F, 1.2F, 2.1F, 0.0F}};
  const OverheadView view = overhead_view(points, kSearchStep);
  ASSERT_EQ(view.columns.size(), 1U);
  EXPECT_EQ(view.columns[0].center, Eigen::Vector2f(1.25F, 1.25F));
  EXPECT_EQ(view.columns[0].lowest, 0.1F);
  EXPECT_EQ(view.columns[0].rise, 2.0F);
}

}  // namespace
}  // namespace adit
