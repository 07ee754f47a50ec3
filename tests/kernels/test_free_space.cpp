// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What submaps say of voxels, beside the twin.
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/free_space.hpp"
#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

constexpr double kEdge = 0.25;  // m

class FreeSpaceKernels : public test::DeviceTest {
 protected:
  /// Sweeps along a street, in which a car stands during every second one.
  static std::vector<PlacedSubmap> drive(std::size_t count) {
    const test::World street = test::make_street(30.0);
    test::World with_car = street;
    with_car.blocks.push_back({{6.0, -1.0, 0.0}, {10.0, 0.8, 1.5}});
    std::vector<PlacedSubmap> submaps;
    for (const StampedPose& pose : test::steady_drive(count, test::twist(0.7, 0.05))) {
      const Sweep sweep =
          test::scan(submaps.size() % 2 == 0 ? with_car : street, pose, test::Lidar{});
      submaps.push_back(test::placed_sweep(sweep.points, pose.pose));
    }
    return submaps;
  }
};

TEST_F(FreeSpaceKernels, VotesAreTheTwins) {
  const std::vector<PlacedSubmap> submaps = drive(5);
  for (const SpaceTile& tile : {SpaceTile{.centre = {20, 0, 4}, .across = 128},
                                SpaceTile{.centre = {-90, 60, 4}, .across = 64}}) {
    const test::FreeSpaceCase made = test::free_space_case(tile, kEdge, submaps);
    test::FreeSpaceRun run(context(), made);
    for (int repeat = 0; repeat < 2; ++repeat) {
      run.run();
      const test::Verdict verdict = test::verify_votes(made, run.table());
      EXPECT_TRUE(verdict.passed()) << verdict.text();
      EXPECT_GT(verdict.worst.at("voxels compared"), 100.0);
      RecordProperty("verdict", verdict.text());
    }
  }
  EXPECT_GT(test::free_space_case({.centre = {20, 0, 4}, .across = 128}, kEdge, submaps).samples(),
            100'000U);
}

TEST_F(FreeSpaceKernels, ManyRaysOfASubmapAreAllFollowed) {
  // More than a software device's few groups could loop through (engine/kernels/launch.hpp).
  std::vector<gpu::SpaceRay> rays(400'000,
                                  {.hit_x = 9,
                                   .hit_y = 9,
                                   .hit_z = 9,
                                   .from_x = 0,
                                   .from_y = 0,
                                   .from_z = 0,
                                   .step_x = 1 << gpu::kSpaceBits,
                                   .step_y = 0,
                                   .step_z = 0,
                                   .samples = 1,
                                   .direction = static_cast<uint32_t>(gpu::kDirectionSteps)});
  for (gpu::SpaceRay& ray : rays) {
    ray.samples = 120;
    ray.from_y = 5 << gpu::kSpaceBits;  // where nothing is
  }
  rays.back().from_y = 0;
  test::FreeSpaceCase made{.table = std::vector<gpu::SpaceVoxel>(256), .submaps = {rays}};
  std::vector<PlacedSubmap> row(1);
  std::vector<Point> points;
  for (int i = 1; i < 100; ++i) {
    points.push_back({static_cast<float>(i) + 0.5F, 0.5F, 0.5F, 0.0F});
  }
  row[0] = test::placed_sweep(points, Eigen::Isometry3d::Identity());
  made.table = space_table({.centre = {0, 0, 0}, .across = 512}, 1.0, 1,
                           [&](std::size_t) { return row[0]; });
  test::FreeSpaceRun run(context(), made);
  run.run();
  std::size_t through = 0;
  for (const gpu::SpaceVoxel& voxel : run.table()) {
    through += voxel.through;
  }
  EXPECT_EQ(through, points.size()) << "by the last ray, one voxel after the other";
}

}  // namespace
}  // namespace adit
