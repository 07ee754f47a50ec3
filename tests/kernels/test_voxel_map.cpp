// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/alignment_scene.hpp"
#include "adit/benchmarks/verify/cases.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using test::DeviceCloud;
using test::Verdict;
using test::VoxelMapRun;
using test::with_random_surfaces;

// Voxels: float32 moves a point by less, and the twin is not asked about points nearer to a border.
constexpr double kVoxelMargin = 1e-4;
constexpr uint32_t kMapSlots = 1U << 15U;

Eigen::Isometry3d tilted_pose() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(12.3, -45.6, 3.2));
  pose.rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.2, 0.9).normalized()));
  return pose;
}

std::vector<gpu::uvec4> certain(const std::vector<gpu::uvec4>& cloud, const Eigen::Isometry3d& pose,
                                double voxel_size) {
  std::vector<gpu::uvec4> kept;
  for (const gpu::uvec4& packed : cloud) {
    if (reference::place_of(pose * reference::decode(packed).p, voxel_size).certain(kVoxelMargin)) {
      kept.push_back(packed);
    }
  }
  return kept;
}

// Everything but the slots' order: a table as a map from keys to cells.
std::map<uint32_t, std::array<uint32_t, 11>> by_key(const std::vector<gpu::GaussianCell>& cells) {
  std::map<uint32_t, std::array<uint32_t, 11>> result;
  for (const gpu::GaussianCell& c : cells) {
    if (c.key != gpu::kFree) {
      result[c.key] = {c.count, c.sum_x, c.sum_y, c.sum_z, c.xx,      c.xy,
                       c.xz,    c.yy,    c.yz,    c.zz,    c.surfaces};
    }
  }
  return result;
}

bool holds_nothing(const std::vector<gpu::GaussianCell>& cells) {
  const auto voxels = by_key(cells);
  return std::all_of(voxels.begin(), voxels.end(),
                     [](const auto& voxel) { return voxel.second == std::array<uint32_t, 11>{}; });
}

class VoxelMapKernel : public test::DeviceTest {
 protected:
  // Adds the cloud at the pose and compares with the twin.
  static Verdict add_and_verify(const std::vector<gpu::uvec4>& cloud, const Eigen::Isometry3d& pose,
                                double voxel_size) {
    VoxelMapRun map(context(), voxel_size, kMapSlots);
    map.add(DeviceCloud(context(), cloud), pose);
    reference::VoxelMap expected{.voxel_size = voxel_size};
    expected.add(reference::decode(cloud), pose);
    EXPECT_EQ(map.counters().failures, 0U);
    EXPECT_EQ(map.counters().out_of_range, expected.out_of_range);
    EXPECT_EQ(map.counters().used_slots, expected.voxels.size());
    return test::verify_voxel_map(expected, map.cells());
  }
};

TEST_F(VoxelMapKernel, MapsAreTheTwinsForPreprocessedSweeps) {
  double kept = 0.0;
  double all = 0.0;
  for (const test::SweepCase& sweep : test::sweep_cases()) {
    test::PreprocessRun preprocess(context(), sweep.settings, sweep.raw);
    preprocess.run();
    for (const double voxel_size : {0.5, 1.3}) {
      for (const Eigen::Isometry3d& pose : {Eigen::Isometry3d::Identity(), tilted_pose()}) {
        SCOPED_TRACE(sweep.name + ", voxels of " + std::to_string(voxel_size) + " m");
        const std::vector<gpu::uvec4> cloud = certain(preprocess.surface_cloud(), pose, voxel_size);
        kept += static_cast<double>(cloud.size());
        all += static_cast<double>(preprocess.surface_cloud().size());
        const Verdict verdict = add_and_verify(cloud, pose, voxel_size);
        EXPECT_TRUE(verdict.passed()) << verdict.text();
        RecordProperty(sweep.name, verdict.text());
      }
    }
  }
  EXPECT_GT(kept, 0.8 * all);  // some clouds lie on borders on purpose
}

TEST_F(VoxelMapKernel, EveryClassAndDirectionGivesItsConstraint) {
  const std::vector<gpu::uvec4> cloud =
      certain(with_random_surfaces(test::room(20'000, 21), 22), tilted_pose(), 0.7);
  const Verdict verdict = add_and_verify(cloud, tilted_pose(), 0.7);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
}

TEST_F(VoxelMapKernel, PointsOnBordersBelongToTheUpperVoxel) {
  // At the identity, with voxels of a power of two, all arithmetic is exact: no margin is needed.
  std::vector<Point> points;
  for (int x = -6; x <= 6; ++x) {
    for (int y = -6; y <= 6; ++y) {
      for (int z = -6; z <= 6; ++z) {
        points.push_back({0.5F * static_cast<float>(x), 0.5F * static_cast<float>(y),
                          0.25F * static_cast<float>(z), 0});
      }
    }
  }
  const Verdict verdict =
      add_and_verify(with_random_surfaces(points, 23), Eigen::Isometry3d::Identity(), 0.5);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
}

TEST_F(VoxelMapKernel, MapDoesNotDependOnTheOrderOfPointsOrClouds) {
  std::vector<gpu::uvec4> first = with_random_surfaces(test::room(8000, 31), 32);
  std::vector<gpu::uvec4> second = with_random_surfaces(test::room(5000, 33), 34);
  VoxelMapRun map(context(), 0.5, kMapSlots);
  map.add(DeviceCloud(context(), first), tilted_pose());
  map.add(DeviceCloud(context(), second), Eigen::Isometry3d::Identity());

  std::reverse(first.begin(), first.end());
  std::rotate(second.begin(), second.begin() + 777, second.end());
  VoxelMapRun other(context(), 0.5, kMapSlots);
  other.add(DeviceCloud(context(), second), Eigen::Isometry3d::Identity());
  other.add(DeviceCloud(context(), first), tilted_pose());
  EXPECT_EQ(by_key(map.cells()), by_key(other.cells()));
  EXPECT_EQ(map.counters().used_slots, other.counters().used_slots);
}

// So many points of all three kinds in one voxel, near its upper corner, where sums are largest.
std::vector<gpu::uvec4> crowd(size_t count) {
  return with_random_surfaces(std::vector<Point>(count, Point{1.9999F, 1.9999F, 1.9999F, 0.0F}),
                              61);
}

TEST_F(VoxelMapKernel, OnePointBeyondWhatAVoxelsSumsHoldIsCounted) {
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (const engine::VoxelContent content :
       {engine::VoxelContent::surfaces, engine::VoxelContent::moments}) {
    const DeviceCloud full(context(), crowd(gpu::kMostCellPoints));
    const DeviceCloud one(context(), crowd(1));
    VoxelMapRun map(context(), 1.0, kMapSlots, content);
    map.add(full, pose);
    EXPECT_EQ(map.counters().crowded, 0U);
    const auto whole = by_key(map.cells());
    ASSERT_EQ(whole.size(), 1U);
    const auto& [count, x, y, z, xx, xy, xz, yy, yz, zz, surfaces] = whole.begin()->second;
    EXPECT_EQ(count & gpu::kCountMask, gpu::kMostCellPoints);
    const double mean = static_cast<double>(x) / gpu::kMostCellPoints / 65536.0;
    EXPECT_NEAR(mean, 0.9999, 1e-5);
    map.add(one, pose);
    EXPECT_EQ(map.counters().crowded, 1U);
    map.remove(one, pose);
    EXPECT_EQ(map.counters().crowded, 1U) << "what is taken out is not counted";
    EXPECT_EQ(by_key(map.cells()), whole) << "right again below the bound";
    for (int more = 0; more < 2; ++more) {
      map.add(full, pose);  // 131 070 and 196 605 points: beyond 65 535, and beyond 131 071
    }
    EXPECT_EQ(map.counters().crowded, 3U);
  }
}

TEST_F(VoxelMapKernel, CloudThatIsTakenOutLeavesNoTrace) {
  const DeviceCloud staying(context(), with_random_surfaces(test::room(6000, 41), 42));
  const DeviceCloud leaving(context(), with_random_surfaces(test::room(9000, 43), 44));
  VoxelMapRun alone(context(), 0.5, kMapSlots);
  alone.add(staying, Eigen::Isometry3d::Identity());

  VoxelMapRun map(context(), 0.5, kMapSlots);
  map.add(leaving, tilted_pose());
  map.add(staying, Eigen::Isometry3d::Identity());
  map.remove(leaving, tilted_pose());
  auto voxels = by_key(map.cells());
  std::erase_if(voxels,
                [](const auto& voxel) { return voxel.second == std::array<uint32_t, 11>{}; });
  EXPECT_EQ(voxels, by_key(alone.cells()));

  map.remove(staying, Eigen::Isometry3d::Identity());
  EXPECT_TRUE(holds_nothing(map.cells()));
  map.clear();
  EXPECT_TRUE(by_key(map.cells()).empty());
  EXPECT_EQ(map.counters().used_slots, 0U);
}

TEST_F(VoxelMapKernel, TableThatIsTooSmallCountsWhatItLoses) {
  const std::vector<gpu::uvec4> cloud = with_random_surfaces(test::room(4000, 51), 52);
  const DeviceCloud points(context(), cloud);
  for (const uint32_t slots : {1U, 16U, 128U}) {
    SCOPED_TRACE(slots);
    VoxelMapRun map(context(), 0.5, slots);
    map.add(points, Eigen::Isometry3d::Identity());
    const gpu::VoxelMapCounters counters = map.counters();
    uint32_t held = 0;
    for (const gpu::GaussianCell& cell : map.cells()) {
      held += points_of(cell);
    }
    EXPECT_EQ(counters.used_slots, slots);
    EXPECT_GT(counters.failures, 0U);
    EXPECT_EQ(held + counters.failures, cloud.size());
    map.remove(points, Eigen::Isometry3d::Identity());
    EXPECT_TRUE(holds_nothing(map.cells()));
  }
}

TEST_F(VoxelMapKernel, TableAtHalfItsLoadLosesNothing) {
  // Chains of probes are long; see LongProbeChainsLoseNothing of the preprocessing.
  std::vector<Point> points;
  for (int i = 0; i < 2048; ++i) {
    points.push_back({static_cast<float>(i % 16) + 0.3F, static_cast<float>(i / 16 % 16) + 0.4F,
                      static_cast<float>(i / 256) + 0.6F, 0.0F});
  }
  const std::vector<gpu::uvec4> cloud = with_random_surfaces(points, 61);
  VoxelMapRun map(context(), 1.0, 4096);
  for (int again = 0; again < 3; ++again) {
    map.add(DeviceCloud(context(), cloud), Eigen::Isometry3d::Identity());
  }
  EXPECT_EQ(map.counters().failures, 0U);
  EXPECT_EQ(map.counters().used_slots, 2048U);
  const auto voxels = by_key(map.cells());
  EXPECT_EQ(voxels.size(), 2048U);
  EXPECT_TRUE(std::all_of(voxels.begin(), voxels.end(), [](const auto& voxel) {
    return (voxel.second[0] & gpu::kCountMask) == 3;
  }));
}

TEST_F(VoxelMapKernel, PointsBeyondTheKeysAreCountedAndLeftOut) {
  // One voxel inside and one outside each face of what keys can name, and far out; voxels of 1 m.
  const std::vector<Point> inside = {{-1023.5F, 0.5F, 0.5F, 0},    {1022.5F, 0.5F, 0.5F, 0},
                                     {0.5F, -1023.5F, 0.5F, 0},    {0.5F, 1023.5F, 0.5F, 0},
                                     {0.5F, 0.5F, -511.5F, 0},     {0.5F, 0.5F, 511.5F, 0},
                                     {1022.5F, 1023.5F, 511.5F, 0}};
  const std::vector<Point> outside = {{-1024.5F, 0.5F, 0.5F, 0}, {1023.5F, 0.5F, 0.5F, 0},
                                      {0.5F, -1024.5F, 0.5F, 0}, {0.5F, 1024.5F, 0.5F, 0},
                                      {0.5F, 0.5F, -512.5F, 0},  {0.5F, 0.5F, 512.5F, 0},
                                      {1e6F, -1e6F, 1e6F, 0}};
  std::vector<Point> points = inside;
  points.insert(points.end(), outside.begin(), outside.end());
  const std::vector<gpu::uvec4> cloud = with_random_surfaces(points, 71);
  const Verdict verdict = add_and_verify(cloud, Eigen::Isometry3d::Identity(), 1.0);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
  EXPECT_EQ(verdict.worst.at("voxels compared"), static_cast<double>(inside.size()));
}

TEST_F(VoxelMapKernel, FullVoxelKeepsItsSums) {
  // The most points a voxel may hold, all near its upper corner and on one plane: the largest sums
  // there are.
  const std::vector<Point> points(65'535, {3.9999F, 4.9999F, 5.9999F, 0.0F});
  std::vector<gpu::uvec4> cloud = with_random_surfaces(points, 81);
  for (gpu::uvec4& point : cloud) {
    point.w = cloud.front().w;
  }
  const Verdict verdict = add_and_verify(cloud, Eigen::Isometry3d::Identity(), 1.0);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
}

TEST_F(VoxelMapKernel, NoPointsChangeNothing) {
  VoxelMapRun map(context(), 1.0, 64);
  map.add(DeviceCloud(context(), {}), Eigen::Isometry3d::Identity());
  EXPECT_TRUE(by_key(map.cells()).empty());
  EXPECT_EQ(map.counters().used_slots, 0U);
}

}  // namespace
}  // namespace adit
