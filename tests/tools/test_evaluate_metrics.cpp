// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluate_metrics.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

/// Poses along x, `step` metres apart.
std::vector<Eigen::Isometry3d> straight(std::size_t count, double step) {
  std::vector<Eigen::Isometry3d> poses(count, Eigen::Isometry3d::Identity());
  for (std::size_t i = 0; i < count; ++i) {
    poses[i].translation().x() = step * static_cast<double>(i);
  }
  return poses;
}

/// Turns by `angle` radians (about z) a pose.
std::vector<Eigen::Isometry3d> curving(std::size_t count, double step, double angle) {
  Vector6d xi = Vector6d::Zero();
  xi(0) = step;
  xi(5) = angle;
  std::vector<Eigen::Isometry3d> poses(count, Eigen::Isometry3d::Identity());
  for (std::size_t i = 1; i < count; ++i) {
    poses[i] = poses[i - 1] * se3_exp(xi);
  }
  return poses;
}

TEST(RpePairs, ByFramesFollowEachOther) {
  const std::vector<IndexPair> expected = {{0, 3}, {3, 6}, {6, 9}};
  EXPECT_EQ(pairs_by_frames(10, 3), expected);
  EXPECT_EQ(pairs_by_frames(12, 3), expected);
  EXPECT_TRUE(pairs_by_frames(3, 3).empty());
  EXPECT_TRUE(pairs_by_frames(0, 1).empty());
}

TEST(RpePairs, ByDistanceBeginAfterTheFirstDelta) {
  // 3 m a pose: the path reaches 10 m at poses 4, 8, 12, ...
  const std::vector<IndexPair> expected = {{4, 8}, {8, 12}};
  EXPECT_EQ(pairs_by_distance(straight(15, 3.0), 10.0, false), expected);
}

TEST(RpePairs, ByDistanceCanBeginAtTheFirstPose) {
  const std::vector<IndexPair> expected = {{0, 4}, {4, 8}, {8, 12}};
  EXPECT_EQ(pairs_by_distance(straight(15, 3.0), 10.0, true), expected);
  EXPECT_TRUE(pairs_by_distance(straight(3, 3.0), 10.0, true).empty());
  EXPECT_TRUE(pairs_by_distance({}, 10.0, true).empty());
}

TEST(Rpe, ConstantDriftShowsInEveryPair) {
  RpeOptions options;
  options.delta = 10.0;
  options.pairs_from = PairSource::truth;
  const RelativeErrors errors = relative_errors(straight(101, 1.02), straight(101, 1.0), options);
  EXPECT_EQ(errors.translation.count, 9U);
  EXPECT_NEAR(errors.translation.min, 0.2, 1e-12);
  EXPECT_NEAR(errors.translation.max, 0.2, 1e-12);
  EXPECT_NEAR(errors.rotation.max, 0.0, 1e-12);
}

TEST(Rpe, PairsCanFollowTheEstimate) {
  RpeOptions options;
  options.delta = 10.0;
  options.from_first_pose = true;
  // The estimate is half as long: its 10 m are 20 m of the truth.
  const RelativeErrors errors = relative_errors(straight(101, 0.5), straight(101, 1.0), options);
  EXPECT_EQ(errors.translation.count, 5U);
  EXPECT_NEAR(errors.translation.mean, 10.0, 1e-12);
}

TEST(Rpe, RotationIsInDegrees) {
  RpeOptions options;
  options.unit = DeltaUnit::frames;
  options.delta = 5.0;
  const RelativeErrors errors =
      relative_errors(curving(21, 1.0, 0.1 * std::numbers::pi / 180.0), straight(21, 1.0), options);
  EXPECT_EQ(errors.rotation.count, 4U);
  EXPECT_NEAR(errors.rotation.mean, 0.5, 1e-10);
}

TEST(KittiSegments, DriftIsAFractionOfTheLength) {
  const std::vector<SegmentErrors> errors =
      kitti_segment_errors(straight(1001, 1.01), straight(1001, 1.0));
  ASSERT_EQ(errors.size(), 9U);
  // A segment ends at the first pose beyond its length: here one metre beyond.
  EXPECT_EQ(errors[0].length, 100.0);
  EXPECT_EQ(errors[0].count, 90U);  // starts 0, 10, ..., 890 leave 101 m
  EXPECT_NEAR(errors[0].translation, 0.01 * 101.0 / 100.0, 1e-12);
  EXPECT_EQ(errors[7].length, 800.0);
  EXPECT_EQ(errors[7].count, 20U);
  EXPECT_NEAR(errors[7].translation, 0.01 * 801.0 / 800.0, 1e-12);
  EXPECT_EQ(errors[8].length, 0.0);
  EXPECT_EQ(errors[8].count, 90U + 80U + 70U + 60U + 50U + 40U + 30U + 20U);
}

TEST(KittiSegments, RotationIsInRadiansPerMetre) {
  const std::vector<SegmentErrors> errors =
      kitti_segment_errors(curving(301, 1.0, 1e-4), straight(301, 1.0));
  EXPECT_NEAR(errors.front().rotation, 101.0 * 1e-4 / 100.0, 1e-12);
}

TEST(KittiSegments, MeanOverAllWeighsSegmentsAlike) {
  const std::vector<SegmentErrors> errors =
      kitti_segment_errors(curving(401, 1.0, 1e-4), straight(401, 1.0));
  ASSERT_EQ(errors.size(), 4U);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += errors[i].translation * static_cast<double>(errors[i].count);
    count += errors[i].count;
  }
  EXPECT_EQ(errors[3].count, count);
  EXPECT_NEAR(errors[3].translation, sum / static_cast<double>(count), 1e-15);
}

TEST(KittiSegments, ShortPathHasNone) {
  const std::vector<SegmentErrors> errors =
      kitti_segment_errors(straight(101, 1.0), straight(101, 1.0));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].count, 0U);
}

}  // namespace
}  // namespace adit
