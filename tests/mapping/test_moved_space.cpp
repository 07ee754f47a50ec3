// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What has moved from one submap to the next.
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/free_space.hpp"
#include "adit/slam/submaps/moved_space.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

constexpr double kEdge = 0.25;  // m
SpaceTile street() {
  return {.centre = {40, 0, 4}, .across = 320};
}

// Of what stands still. These submaps know no surfaces, so that rays along walls count, too.
constexpr double kMostLost = 0.015;

using Voxel = std::tuple<int64_t, int64_t, int64_t>;

class MovedSpaceTest : public test::DeviceTest {
 protected:
  struct Drive {
    std::vector<PlacedSubmap> submaps;
    std::vector<Eigen::Vector3d> of_car;     ///< points in the map, of what drives by
    std::vector<Eigen::Vector3d> of_street;  ///< all others
  };

  /// Sweeps along a street. Oncoming traffic: a car that is elsewhere in every sweep; one that
  /// stands where it is the whole time is among the street's.
  static Drive drive(std::size_t count, bool with_traffic = true) {
    Drive made;
    const test::Lidar lidar{.beams = 32, .columns = 720};
    for (const StampedPose& pose : test::steady_drive(count, test::twist(1.2))) {
      const double x = 22.0 - 2.5 * static_cast<double>(made.submaps.size());
      test::World world = test::make_street(40.0);
      if (with_traffic) {
        world.blocks.push_back({{x, 1.2, 0.0}, {x + 4.2, 3.0, 1.5}});
      }
      const Sweep sweep = test::scan(world, pose, lidar);
      for (const Point& point : test::returns(sweep)) {
        const Eigen::Vector3d p = pose.pose * Eigen::Vector3d(point.x, point.y, point.z);
        const bool car = with_traffic && p.x() > x - 0.05 && p.x() < x + 4.25 && p.y() > 1.15 &&
                         p.y() < 3.05 && p.z() > 0.1;
        (car ? made.of_car : made.of_street).push_back(p);
      }
      made.submaps.push_back(test::placed_sweep(sweep.points, pose.pose));
    }
    return made;
  }

  MovedSpace moved(const Drive& made, const std::vector<SpaceTile>& tiles) {
    const MovedSpaceSearch search(context(), kEdge);
    MovedSpace space(kEdge);
    for (const SpaceTile& tile : tiles) {
      for (const VoxelIndex& voxel : search.in_tile(
               tile, made.submaps.size(), [&](std::size_t i) { return made.submaps[i]; })) {
        space.add(voxel);
      }
    }
    return space;
  }

  static double share(const MovedSpace& space, const std::vector<Eigen::Vector3d>& points) {
    std::size_t inside = 0;
    for (const Eigen::Vector3d& p : points) {
      inside += space.contains(p) ? 1U : 0U;
    }
    return static_cast<double>(inside) / static_cast<double>(points.size());
  }
};

TEST_F(MovedSpaceTest, WhatDrivesByIsFoundAndTheStreetStays) {
  const Drive made = drive(12);
  ASSERT_GT(made.of_car.size(), 1000U);
  const MovedSpace space = moved(made, {street()});
  EXPECT_GT(share(space, made.of_car), 0.8);
  EXPECT_LT(share(space, made.of_street), kMostLost);
}

TEST_F(MovedSpaceTest, OfAStreetWhereNothingMovesNextToNothingIsTaken) {
  const Drive made = drive(12, false);
  EXPECT_LT(share(moved(made, {street()}), made.of_street), kMostLost);
}

TEST_F(MovedSpaceTest, OneWitnessIsNotEnough) {
  Drive made = drive(2);  // of each car's place only the other submap can tell
  EXPECT_EQ(moved(made, {street()}).voxels(), 0U);
}

TEST_F(MovedSpaceTest, TilesDoNotMatterAndTwiceIsTheSame) {
  const Drive made = drive(8);
  std::vector<SpaceTile> quarters;
  for (const int64_t x : {-80, 80}) {
    for (const int64_t y : {-80, 80}) {
      quarters.push_back({.centre = {40 + x, y, 4}, .across = 160});
    }
  }
  const MovedSpaceSearch search(context(), kEdge);
  const auto found = [&](const std::vector<SpaceTile>& tiles) {
    std::set<Voxel> voxels;
    for (const SpaceTile& tile : tiles) {
      for (const VoxelIndex& voxel : search.in_tile(
               tile, made.submaps.size(), [&](std::size_t i) { return made.submaps[i]; })) {
        EXPECT_TRUE(voxels.emplace(voxel.x(), voxel.y(), voxel.z()).second) << "in two tiles";
      }
    }
    return voxels;
  };
  const std::set<Voxel> whole = found({street()});
  EXPECT_GT(whole.size(), 50U);
  EXPECT_EQ(found(quarters), whole);
  EXPECT_EQ(found({street()}), whole);
}

TEST_F(MovedSpaceTest, RaysAreTheSameSamplesInEveryTile) {
  const Drive made = drive(1);
  const auto samples = [&](const std::vector<SpaceTile>& tiles) {
    std::set<Voxel> voxels;
    for (const SpaceTile& tile : tiles) {
      for (const gpu::SpaceRay& ray : space_rays(tile, kEdge, made.submaps[0])) {
        const Eigen::Array3i from(ray.from_x, ray.from_y, ray.from_z);
        const Eigen::Array3i step(ray.step_x, ray.step_y, ray.step_z);
        for (uint32_t k = 0; k < ray.samples; ++k) {
          const Eigen::Array3i at = from + static_cast<int>(k) * step;
          const int half = static_cast<int>(tile.across / 2);
          const Eigen::Array3i voxel = at.unaryExpr([](int x) { return x >> gpu::kSpaceBits; });
          if ((voxel.head<2>() >= -half).all() && (voxel.head<2>() < half).all()) {
            voxels.emplace(voxel.x() + tile.centre.x(), voxel.y() + tile.centre.y(),
                           voxel.z() + tile.centre.z());
          }
        }
      }
    }
    return voxels;
  };
  const std::set<Voxel> whole = samples({{.centre = {0, 0, 0}, .across = 256}});
  EXPECT_GT(whole.size(), 10'000U);
  EXPECT_EQ(samples({{.centre = {-64, -64, 0}, .across = 128},
                     {.centre = {64, -64, 7}, .across = 128},
                     {.centre = {-64, 64, -9}, .across = 128},
                     {.centre = {64, 64, 0}, .across = 128}}),
            whole);
}

TEST_F(MovedSpaceTest, FarFromTheOriginVoxelsAreTheirOwn) {
  MovedSpace space(0.2);
  space.add({-100'000, 250'000, -3});
  EXPECT_TRUE(space.contains({-19'999.9, 50'000.1, -0.5}));
  EXPECT_FALSE(space.contains({-19'999.7, 50'000.1, -0.5}));
  EXPECT_FALSE(space.contains({0.1, 0.1, 0.1}));
}

}  // namespace
}  // namespace adit
