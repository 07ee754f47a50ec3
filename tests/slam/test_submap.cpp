// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/engine/kernels/voxel_map.hpp"
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/slam/odometry/submap.hpp"
#include "adit/slam/registration/registration.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

using Sums = std::array<uint32_t, 11>;
/// What a voxel map holds, by key; where a voxel stands in the table depends on who came first.
using Voxels = std::map<uint32_t, Sums>;

struct Cloud {
  std::vector<gpu::uvec4> points;
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
};

/// Points all around a sensor at this pose, with arbitrary surfaces.
Cloud some_cloud(uint64_t seed, const Eigen::Isometry3d& pose, size_t count = 3000,
                 double radius = 30.0) {
  Random random(seed);
  Cloud cloud{.points = {}, .T_map_lidar = pose};
  for (size_t i = 0; i < count; ++i) {
    const auto coordinate = [&](double bound) {
      return std::bit_cast<uint32_t>(static_cast<float>(random.uniform(-bound, bound)));
    };
    const auto kind = static_cast<uint32_t>(random.uniform(0.0, 3.0));
    const auto direction = static_cast<uint32_t>(random.uniform(0.0, 0x1p30));
    cloud.points.push_back({coordinate(radius), coordinate(radius), coordinate(0.1 * radius),
                            (kind << 30U) | direction});
  }
  return cloud;
}

Eigen::Isometry3d pose_after(double forward, double yaw = 0.0) {
  Vector6d xi = Vector6d::Zero();
  xi(0) = forward;
  xi(5) = yaw;
  return se3_exp(xi);
}

Voxels voxels_of(const std::vector<gpu::GaussianCell>& table) {
  Voxels voxels;
  for (const gpu::GaussianCell& c : table) {
    const Sums sums{c.count, c.sum_x, c.sum_y, c.sum_z, c.xx,      c.xy,
                    c.xz,    c.yy,    c.yz,    c.zz,    c.surfaces};
    if (c.key == gpu::kFree) {
      EXPECT_EQ(sums, Sums{}) << "a free slot holds sums";
    } else if (c.count > 0) {
      EXPECT_TRUE(voxels.emplace(c.key, sums).second) << "a voxel is in the table twice";
    } else {
      EXPECT_EQ(sums, Sums{}) << "a voxel that every cloud has left holds sums";
    }
  }
  return voxels;
}

class SubmapTest : public test::DeviceTest {
 protected:
  /// What Odometry does with an aligned sweep: its cloud joins, and the map is brought up to date.
  SubmapLoss add(Submap& submap, const Cloud& cloud) {
    const auto count = static_cast<uint32_t>(cloud.points.size());
    const engine::Slice next = submap.next_cloud(count);
    const engine::Buffer points = upload(cloud.points);
    run([&](engine::Recorder& recorder) { recorder.copy(points, next.sub(0, points.size())); });
    submap.push(count, cloud.T_map_lidar);
    return update(submap);
  }
  SubmapLoss update(Submap& submap) {
    run([&](engine::Recorder& recorder) { submap.record_update(recorder); });
    return submap.note_counters(download<gpu::VoxelMapCounters>(submap.voxel_map().counters)[0]);
  }
  static Voxels voxels_in(const Submap& submap) {
    return voxels_of(download<gpu::GaussianCell>(submap.voxel_map().table));
  }
  /// A voxel map of the same clouds made from nothing, in the submap's frame.
  Voxels from_scratch(const Submap& submap, const std::vector<Cloud>& clouds) {
    engine::VoxelMapKernels kernels(context());
    constexpr uint32_t kSlots = 1U << 18U;
    const engine::Buffer table = context().make_buffer(engine::VoxelMapKernels::table_bytes(kSlots),
                                                       engine::Memory::device, "map from scratch");
    const engine::Buffer counters = context().make_buffer(
        sizeof(gpu::VoxelMapCounters), engine::Memory::device, "counters from scratch");
    const engine::VoxelMapView view{
        .table = table, .counters = counters, .voxel_size = submap.voxel_map().voxel_size};
    std::vector<engine::Buffer> points;
    for (const Cloud& cloud : clouds) {
      points.push_back(upload(cloud.points));
    }
    run([&](engine::Recorder& recorder) {
      kernels.record_clear(recorder, view);
      for (size_t i = 0; i < clouds.size(); ++i) {
        kernels.record_add(recorder, view, points[i],
                           static_cast<uint32_t>(clouds[i].points.size()),
                           to_device(submap.pose().inverse() * clouds[i].T_map_lidar));
      }
    });
    EXPECT_EQ(download<gpu::VoxelMapCounters>(counters)[0].failures, 0U);
    return voxels_of(download<gpu::GaussianCell>(table));
  }
};

Config config_of(int l, double r_align = 0.5) {
  Config config;
  config.submap.l = l;
  config.registration.r_align = r_align;
  return config;
}

TEST_F(SubmapTest, IsEmptyUntilACloudJoinsAndAfterClear) {
  Submap submap(context(), config_of(3));
  EXPECT_TRUE(submap.empty());
  add(submap, some_cloud(1, pose_after(0.0)));
  EXPECT_FALSE(submap.empty());
  submap.clear();
  EXPECT_TRUE(submap.empty());
}

TEST_F(SubmapTest, TellsOfAVoxelThatHoldsMorePointsThanItsSums) {
  Submap submap(context(), config_of(3));
  Cloud crowd = some_cloud(7, pose_after(0.0), 30'000);
  std::ranges::fill(crowd.points, crowd.points.front());
  EXPECT_EQ(add(submap, crowd).crowded_voxels, 0U);
  EXPECT_EQ(add(submap, crowd).crowded_voxels, 0U);
  EXPECT_EQ(add(submap, crowd).crowded_voxels, 1U) << "90 000 points";
  EXPECT_EQ(update(submap).crowded_voxels, 0U) << "since last time";
}

TEST_F(SubmapTest, HoldsTheLastCloudsAndNoTraceOfThoseBefore) {
  Submap submap(context(), config_of(3));
  std::vector<Cloud> last;
  for (uint64_t i = 0; i < 8; ++i) {
    const Cloud cloud =
        some_cloud(i, pose_after(0.8 * static_cast<double>(i), 0.02 * static_cast<double>(i)));
    EXPECT_EQ(add(submap, cloud).points, 0U) << "points lost";
    last.push_back(cloud);
    if (last.size() > 3) {
      last.erase(last.begin());
    }
    ASSERT_EQ(voxels_in(submap), from_scratch(submap, last)) << "after cloud " << i;
  }
}

TEST_F(SubmapTest, GoesOnWhereItWasMovedTo) {
  auto first = std::make_unique<Submap>(context(), config_of(2));
  std::vector<Cloud> clouds;
  for (uint64_t i = 0; i < 3; ++i) {
    clouds.push_back(some_cloud(i, pose_after(static_cast<double>(i))));
  }
  add(*first, clouds[0]);
  add(*first, clouds[1]);
  Submap second = std::move(*first);
  first.reset();
  add(second, clouds[2]);
  EXPECT_EQ(voxels_in(second), from_scratch(second, {clouds[1], clouds[2]}));
}

TEST_F(SubmapTest, WantsTheFirstTenAndThenWhatIsSeenFromElsewhere) {
  for (const int l : {4, 10, 20}) {
    Config config = config_of(l);
    config.submap.delta_trans = 0.5;
    config.submap.delta_rot = 0.3;
    Submap submap(context(), config);
    for (int i = 0; i < std::min(l, 10); ++i) {
      EXPECT_TRUE(submap.wants(pose_after(0.0))) << "cloud " << i << " of " << l;
      add(submap, some_cloud(1, pose_after(0.0), 10));
    }
    EXPECT_FALSE(submap.wants(pose_after(0.0)));
    EXPECT_FALSE(submap.wants(pose_after(0.49, 0.29)));
    EXPECT_TRUE(submap.wants(pose_after(0.51)));
    EXPECT_TRUE(submap.wants(pose_after(0.0, -0.31)));
    add(submap, some_cloud(1, pose_after(0.6), 10));
    EXPECT_FALSE(submap.wants(pose_after(0.7))) << "from the newest on";
    EXPECT_TRUE(submap.wants(pose_after(0.0)));
  }
}

TEST_F(SubmapTest, OneCloudIsASubmapToo) {
  Submap submap(context(), config_of(1));
  for (uint64_t i = 0; i < 3; ++i) {
    const Cloud cloud = some_cloud(i, pose_after(static_cast<double>(i)));
    add(submap, cloud);
    ASSERT_EQ(voxels_in(submap), from_scratch(submap, {cloud}));
  }
}

TEST_F(SubmapTest, ACloudJoinsOnceHoweverOftenTheMapIsUpdated) {
  Submap submap(context(), config_of(4));
  const std::vector<Cloud> clouds = {some_cloud(1, pose_after(0.0)),
                                     some_cloud(2, pose_after(1.0))};
  add(submap, clouds[0]);
  add(submap, clouds[1]);
  update(submap);  // a sweep that failed: nothing was pushed
  update(submap);
  EXPECT_EQ(voxels_in(submap), from_scratch(submap, clouds));
}

TEST_F(SubmapTest, CloudsOfAnySizeIncludingNoneTakeTheirTurn) {
  Submap submap(context(), config_of(2));
  std::vector<Cloud> clouds;
  for (const size_t count : {100U, 0U, 5000U, 1U, 64U, 70000U}) {
    clouds.push_back(some_cloud(count, pose_after(0.0), count));
    const engine::Slice next = submap.next_cloud(static_cast<uint32_t>(count));
    if (count > 0) {
      const engine::Buffer points = upload(clouds.back().points);
      run([&](engine::Recorder& recorder) { recorder.copy(points, next.sub(0, points.size())); });
    }
    submap.push(static_cast<uint32_t>(count), clouds.back().T_map_lidar);
    update(submap);
  }
  const std::vector<Cloud> last(clouds.end() - 2, clouds.end());
  update(submap);  // the last one may have asked for a larger table
  EXPECT_EQ(voxels_in(submap), from_scratch(submap, last));
}

TEST_F(SubmapTest, TheFrameStaysWhileTheSensorIsNearAndFollowsItBeyondReach) {
  Submap submap(context(), config_of(2));
  std::vector<Cloud> clouds;
  int moves = 0;
  Eigen::Isometry3d frame;
  for (int i = 0; i < 12; ++i) {  // 330 m
    clouds.push_back(some_cloud(static_cast<uint64_t>(i), pose_after(30.0 * i, 0.01 * i)));
    EXPECT_EQ(add(submap, clouds.back()).points, 0U) << "points lost";
    const double distance =
        (submap.pose().translation() - clouds.back().T_map_lidar.translation()).norm();
    EXPECT_LE(distance, 100.0) << "cloud " << i;
    if (i > 0 && submap.pose().matrix() != frame.matrix()) {
      ++moves;
      EXPECT_EQ(distance, 0.0) << "the frame moves to the newest pose";
    }
    frame = submap.pose();
    const std::vector<Cloud> last(clouds.end() - std::min<long>(2, std::ssize(clouds)),
                                  clouds.end());
    ASSERT_EQ(voxels_in(submap), from_scratch(submap, last)) << "cloud " << i;
  }
  EXPECT_EQ(moves, 2);  // at 120 m and 240 m
}

TEST_F(SubmapTest, FarFromTheMapsOriginVoxelsAreAsFineAsNearIt) {
  // 1000 km from the origin float32 knows 6 cm; the submap's own frame knows no such distance.
  const Eigen::Isometry3d far = Eigen::Translation3d(1e6, -1e6, 500.0) * pose_after(0.0);
  Submap near_submap(context(), config_of(2));
  Submap far_submap(context(), config_of(2));
  for (int i = 0; i < 2; ++i) {
    // Steps that both positions hold exactly.
    add(near_submap, some_cloud(static_cast<uint64_t>(i), pose_after(0.25 * i)));
    add(far_submap, some_cloud(static_cast<uint64_t>(i), far * pose_after(0.25 * i)));
  }
  EXPECT_EQ(voxels_in(near_submap), voxels_in(far_submap));
}

TEST_F(SubmapTest, ATableThatFillsUpIsReplacedByALargerOne) {
  // Every point has a voxel of its own, nearly: four clouds fill more than half of the first table.
  Submap submap(context(), config_of(10, 0.25));
  const uint32_t slots = submap.voxel_map().slots();
  std::vector<Cloud> clouds;
  for (int i = 0; i < 6; ++i) {
    clouds.push_back(some_cloud(static_cast<uint64_t>(i), pose_after(0.1 * i), 12'000));
    EXPECT_EQ(add(submap, clouds.back()).points, 0U) << "cloud " << i;
  }
  EXPECT_GT(submap.voxel_map().slots(), slots);
  EXPECT_EQ(voxels_in(submap), from_scratch(submap, clouds));
}

TEST_F(SubmapTest, ATableTooSmallForACloudSaysWhatItLostAndIsWholeAfterwards) {
  Submap submap(context(), config_of(2, 0.25));
  const Cloud cloud = some_cloud(1, pose_after(0.0), 120'000);
  EXPECT_GT(add(submap, cloud).points, 0U)
      << "120 000 voxels do not fit into " << submap.voxel_map().slots() << " slots";
  EXPECT_EQ(update(submap).points, 0U);
  EXPECT_EQ(voxels_in(submap), from_scratch(submap, {cloud}));
}

TEST_F(SubmapTest, InvalidateForgetsTheTableButNoCloud) {
  Submap submap(context(), config_of(3));
  std::vector<Cloud> clouds;
  for (uint64_t i = 0; i < 3; ++i) {
    clouds.push_back(some_cloud(i, pose_after(static_cast<double>(i))));
    add(submap, clouds.back());
  }
  run([&](engine::Recorder& recorder) { recorder.fill(submap.voxel_map().table, 0x12345678U); });
  submap.invalidate();
  update(submap);
  EXPECT_EQ(voxels_in(submap), from_scratch(submap, clouds));
}

TEST_F(SubmapTest, ACoarseMapHoldsTheSameCloudsInLargerVoxels) {
  Submap submap(context(), config_of(2));
  std::vector<Cloud> clouds;
  for (uint64_t i = 0; i < 4; ++i) {
    clouds.push_back(some_cloud(i, pose_after(static_cast<double>(i))));
    add(submap, clouds.back());
  }
  const Voxels fine = voxels_in(submap);
  engine::VoxelMapView coarse;
  run([&](engine::Recorder& recorder) { coarse = submap.record_coarse(recorder, 8.0); });
  EXPECT_EQ(coarse.voxel_size, 4.0);
  uint32_t points = 0;
  for (const auto& [key, sums] : voxels_of(download<gpu::GaussianCell>(coarse.table))) {
    points += sums[0] & gpu::kCountMask;
  }
  EXPECT_EQ(points, clouds[2].points.size() + clouds[3].points.size());
  EXPECT_EQ(voxels_in(submap), fine) << "the fine map is left alone";
}

TEST_F(SubmapTest, NoVoxelOfACoarseMapOverflowsHoweverManyDensePointsTheCloudsHave) {
  // A small room at a fine resolution: the whole of it lies in one coarse voxel, and ten clouds of
  // it have more points than a voxel's sums can hold.
  Config config = config_of(10, 0.25);
  config.preprocess.r_input = 0.05;
  Submap submap(context(), config);
  std::vector<Cloud> clouds;
  const Eigen::Isometry3d inside(Eigen::Translation3d(1.9, 1.9, 1.9));
  add(submap, some_cloud(99, pose_after(0.0), 10));  // the frame's origin is a corner of the room
  for (uint64_t i = 0; i < 10; ++i) {
    clouds.push_back(some_cloud(i, inside, 15'000, 1.8));
    add(submap, clouds.back());
  }
  for (const double factor : {16.0, 8.0, 2.0}) {
    engine::VoxelMapView coarse;
    run([&](engine::Recorder& recorder) { coarse = submap.record_coarse(recorder, factor); });
    uint32_t points = 0;
    for (const auto& [key, sums] : voxels_of(download<gpu::GaussianCell>(coarse.table))) {
      const uint32_t count = sums[0] & gpu::kCountMask;
      EXPECT_LE(sums[0] >> gpu::kFacingShift, count)
          << "more planes than points in a voxel of " << coarse.voxel_size << " m";
      points += count;
    }
    EXPECT_GE(points, 15'000U) << "the newest cloud is always there";
    if (factor == 2.0) {
      EXPECT_EQ(points, 150'000U) << "small voxels have room for all";
    }
  }
}

}  // namespace
}  // namespace adit
