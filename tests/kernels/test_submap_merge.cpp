// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds merged into cells, and surfaces seen from several places, beside their twins.
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

constexpr double kEdge = 0.3;  // m
constexpr uint32_t kSlots = 1U << 17U;

class SubmapKernels : public test::DeviceTest {
 protected:
  struct Drive {
    std::vector<Sweep> sweeps;
    std::vector<StampedPose> poses;

    std::vector<reference::CloudToMerge> clouds() const {
      std::vector<reference::CloudToMerge> clouds;
      for (std::size_t i = 0; i < sweeps.size(); ++i) {
        clouds.push_back({.points = sweeps[i].points,
                          .T_submap_lidar = poses.front().pose.inverse() * poses[i].pose});
      }
      return clouds;
    }
  };

  static Drive drive(std::size_t count) {
    const test::World world = test::make_street(30.0);
    Drive made{.sweeps = {}, .poses = test::steady_drive(count, test::twist(0.6, 0.1))};
    for (const StampedPose& pose : made.poses) {
      Sweep& sweep = made.sweeps.emplace_back(test::scan(world, pose, test::Lidar{}));
      std::erase_if(sweep.points, [](const Point& p) { return p.x == 0.0F && p.y == 0.0F; });
    }
    return made;
  }
};

TEST_F(SubmapKernels, CellsAreTheTwins) {
  const Drive made = drive(5);
  const std::vector<reference::CloudToMerge> clouds = made.clouds();
  test::SubmapMergeRun run(context(), clouds, kEdge, kSlots);
  run.run();
  const reference::MergedClouds twin =
      reference::merge(clouds, kEdge, 2.0 * test::kMovedPointError);
  const test::Verdict verdict = test::verify_merged(twin, run.cells());
  EXPECT_TRUE(verdict.passed()) << verdict.text();
  EXPECT_GT(verdict.worst.at("cells compared"), 0.9 * static_cast<double>(twin.cells.size()));
  EXPECT_EQ(run.counters().failures, 0U);
  EXPECT_EQ(run.counters().out_of_range, 0U);
  RecordProperty("verdict", verdict.text());
}

TEST_F(SubmapKernels, TheOrderOfCloudsDoesNotMatter) {
  const Drive made = drive(3);
  std::vector<reference::CloudToMerge> clouds = made.clouds();
  test::SubmapMergeRun forwards(context(), clouds, kEdge, kSlots);
  forwards.run();
  const auto by_key = [](const std::vector<gpu::MergeCell>& cells) {
    std::map<uint32_t, std::array<uint32_t, 4>> sums;  // the number of the nearest sweep apart
    for (const gpu::MergeCell& cell : cells) {
      if (cell.key != gpu::kFree) {
        sums[cell.key] = {cell.count, cell.sum_x, cell.sum_y, cell.sum_z};
      }
    }
    return sums;
  };
  std::ranges::reverse(clouds);
  test::SubmapMergeRun backwards(context(), clouds, kEdge, kSlots);
  backwards.run();
  EXPECT_EQ(by_key(forwards.cells()), by_key(backwards.cells()));
}

TEST_F(SubmapKernels, PointsTooFarAwayAreCounted) {
  const std::vector<Point> points = {{1.0F, 2.0F, 0.5F, 0.0F}, {0.0F, 0.0F, 400.0F, 0.0F}};
  const std::vector<reference::CloudToMerge> clouds = {{.points = points}};
  test::SubmapMergeRun run(context(), clouds, kEdge, 64);
  run.run();
  EXPECT_EQ(run.counters().out_of_range, 1U);
  EXPECT_EQ(run.counters().used_slots, 1U);
}

TEST_F(SubmapKernels, FullCellsKeepTheirMeanAndCountThoseBeyond) {
  for (const std::size_t count : {std::size_t{gpu::kMostCellPoints}, std::size_t{70'000}}) {
    const std::vector<Point> points(count, Point{0.29999F, 0.29999F, 0.29999F, 0.0F});
    const std::vector<reference::CloudToMerge> clouds = {{.points = points}};
    test::SubmapMergeRun run(context(), clouds, kEdge, 64);
    run.run();
    for (const gpu::MergeCell& cell : run.cells()) {
      if (cell.key != gpu::kFree) {
        EXPECT_EQ(cell.count, count) << "the host sees that there were too many";
        const double mean = static_cast<double>(cell.sum_x) / static_cast<double>(count) / 65536.0;
        EXPECT_EQ(mean > 0.9999, count <= gpu::kMostCellPoints);
      }
    }
  }
}

TEST_F(SubmapKernels, ASurfaceCellWithMorePointsThanItsSumsHoldShowsNone) {
  const engine::PreprocessSettings settings{
      .r_input = kEdge, .beam_spacing = 0.01, .surface_size = 16.0};
  for (const uint32_t count : {gpu::kMostCellPoints, gpu::kMostCellPoints + 1U}) {
    std::vector<gpu::uvec4> points;
    for (uint32_t i = 0; i < count; ++i) {
      points.push_back({std::bit_cast<uint32_t>(8.0F),
                        std::bit_cast<uint32_t>(1.0F + 0.02F * static_cast<float>(i % 300)),
                        std::bit_cast<uint32_t>(1.0F + 0.02F * static_cast<float>(i / 300)), 0});
    }
    test::SubmapSurfacesRun run(context(), settings, points, {Eigen::Vector3f::Zero()});
    run.run();
    std::size_t planes = 0;
    for (const reference::SurfacePoint& point : reference::decode(run.surface_cloud())) {
      planes += reference::is_plane(point.kind) ? 1U : 0U;
    }
    EXPECT_EQ(planes, count == gpu::kMostCellPoints ? count : 0U);
  }
}

TEST_F(SubmapKernels, SurfacesAreTheTwinsSeenFromEachSensor) {
  const Drive made = drive(3);
  const std::vector<reference::CloudToMerge> clouds = made.clouds();
  const engine::PreprocessSettings settings{.r_input = kEdge,
                                            .beam_spacing = test::Lidar{}.beam_spacing()};
  std::vector<Eigen::Vector3f> sensors;
  for (const reference::CloudToMerge& cloud : clouds) {
    sensors.push_back(cloud.T_submap_lidar.translation().cast<float>());
  }
  std::vector<reference::SeenPoint> seen;
  std::vector<gpu::uvec4> points;
  for (const auto& [at, cell] : reference::merge(clouds, kEdge, 0.0).cells) {
    const Eigen::Vector3d corner(static_cast<double>(at[0]), static_cast<double>(at[1]),
                                 static_cast<double>(at[2]));
    const Eigen::Vector3f p = ((corner + cell.mean) * kEdge).cast<float>();
    seen.push_back({.p = p, .ray = p - sensors[cell.nearest]});
    points.push_back({std::bit_cast<uint32_t>(p.x()), std::bit_cast<uint32_t>(p.y()),
                      std::bit_cast<uint32_t>(p.z()), cell.nearest});
  }
  test::SubmapSurfacesRun run(context(), settings, points, sensors);
  run.run();
  const test::Verdict verdict = test::verify_surfaces(settings, seen, run.surface_cloud());
  EXPECT_TRUE(verdict.passed()) << verdict.text();
  EXPECT_GT(verdict.worst.at("normals compared"), 1000.0);
  RecordProperty("verdict", verdict.text());
}

// The trunks of trees 8 m around a sensor, as beams 2 degrees apart see them.
std::vector<gpu::uvec4> trunks(int beams) {
  constexpr double kRadius = 0.35;
  constexpr double kDistance = 8.0;
  Random random(13);
  std::vector<gpu::uvec4> points;
  for (int beam = 0; beam < beams; ++beam) {
    const double elevation = (4.0 + 2.0 * beam) / 57.29578;
    for (int column = 0; column < 1800; ++column) {
      const double azimuth = 2.0 * 3.14159265 * column / 1800.0;
      // One trunk every 18 degrees: how far the ray passes its middle.
      const double off = std::remainder(azimuth, 3.14159265 / 10.0) * kDistance;
      if (std::abs(off) < kRadius) {
        const double flat = kDistance - std::sqrt(kRadius * kRadius - off * off);
        const double range = flat / std::cos(elevation) + 0.01 * random.gaussian();
        const Eigen::Vector3f p(static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)),
                                static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)),
                                static_cast<float>(range * std::sin(elevation)));
        points.push_back({std::bit_cast<uint32_t>(p.x()), std::bit_cast<uint32_t>(p.y()),
                          std::bit_cast<uint32_t>(p.z()), 0});
      }
    }
  }
  return points;
}

// What one beam draws on a trunk is an arc in the plane of the scan, which moves with the sensor.
TEST_F(SubmapKernels, AnArcOfOneBeamIsNoPlane) {
  const engine::PreprocessSettings settings{.r_input = 0.1, .beam_spacing = 2.0 / 57.29578};
  const std::vector<Eigen::Vector3f> sensor = {Eigen::Vector3f::Zero()};
  const auto planes = [&](int beams) {
    test::SubmapSurfacesRun run(context(), settings, trunks(beams), sensor);
    run.run();
    std::vector<reference::SurfacePoint> points = reference::decode(run.surface_cloud());
    std::erase_if(points, [](const auto& point) { return !reference::is_plane(point.kind); });
    return points;
  };
  EXPECT_TRUE(planes(1).empty());
  const std::vector<reference::SurfacePoint> of_three = planes(3);
  EXPECT_GT(of_three.size(), 900U);
  const auto flat = std::ranges::count_if(
      of_three, [](const auto& point) { return std::abs(point.direction.z()) > 0.7; });
  EXPECT_LT(static_cast<double>(flat), 0.02 * static_cast<double>(of_three.size()));
}

}  // namespace
}  // namespace adit
