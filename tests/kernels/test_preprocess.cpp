// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/cases.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

using test::PreprocessRun;
using test::SweepCase;
using test::Verdict;

class PreprocessKernels : public test::DeviceTest {};

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// Centroid and surface of each cell, by the centroid's bits.
std::map<std::array<uint32_t, 3>, uint32_t> by_position(
    const std::vector<gpu::uvec4>& surface_cloud) {
  std::map<std::array<uint32_t, 3>, uint32_t> result;
  for (const gpu::uvec4& p : surface_cloud) {
    result[{p.x, p.y, p.z}] = p.w;
  }
  return result;
}

std::vector<Point> shuffled(std::vector<Point> points, uint64_t seed) {
  Random random(seed);
  for (size_t i = points.size(); i > 1; --i) {
    std::swap(points[i - 1],
              points[static_cast<size_t>(random.uniform(0.0, static_cast<double>(i)))]);
  }
  return points;
}

TEST_F(PreprocessKernels, CentroidsAreTheTwinsOnEveryCase) {
  for (const SweepCase& sweep : test::sweep_cases()) {
    SCOPED_TRACE(sweep.name);
    PreprocessRun run(context(), sweep.settings, sweep.raw);
    run.run();
    const Verdict verdict =
        test::verify_downsample(sweep.settings, sweep.raw, run.counters(), run.cloud());
    EXPECT_TRUE(verdict.passed()) << verdict.text();
    RecordProperty(sweep.name, verdict.text());
  }
}

TEST_F(PreprocessKernels, SurfacesAreTheTwinsOnEveryCase) {
  double normals = 0.0;
  double lines = 0.0;
  for (const SweepCase& sweep : test::sweep_cases()) {
    SCOPED_TRACE(sweep.name);
    PreprocessRun run(context(), sweep.settings, sweep.raw);
    run.run();
    EXPECT_EQ(run.counters().surface_failures, 0U);
    Verdict verdict = test::verify_surfaces(sweep.settings, run.cloud(), run.surface_cloud());
    EXPECT_TRUE(verdict.passed()) << verdict.text();
    normals += verdict.worst["normals compared"];
    lines += verdict.worst["lines compared"];
    RecordProperty(sweep.name, verdict.text());
  }
  EXPECT_GT(normals, 10'000.0);
  EXPECT_GT(lines, 50.0);
}

TEST_F(PreprocessKernels, NormalsAtAHundredMetresAreTheWalls) {
  // What float32 sums of squares in sensor coordinates would get wrong by ten degrees: patches of
  // walls 5 m wide, 96 m away, with 2 mm noise. Truth, not the twin, is the judge: with 30 or more
  // neighbours over a metre, the noise turns a normal by less than 0.3 degrees.
  Random random(11);
  std::vector<Point> raw;
  for (int i = 0; i < 40'000; ++i) {
    const double u = random.uniform(-2.5, 2.5);
    const double v = random.uniform(-2.5, 2.5);
    const double noise = 0.002 * random.gaussian();
    raw.push_back(
        {static_cast<float>(96.0 + noise), static_cast<float>(u), static_cast<float>(v), 0.0F});
  }
  const engine::PreprocessSettings settings{
      .c_min = 0.5, .c_max = 110.0, .r_input = 0.1, .beam_spacing = 0.004};
  PreprocessRun run(context(), settings, raw);
  run.run();
  int planes = 0;
  double worst = 0.0;
  for (const reference::SurfacePoint& point : reference::decode(run.surface_cloud())) {
    // Cells at the border of the patch may hold a sliver of it, which has no normal.
    if (std::max(std::abs(point.p.y()), std::abs(point.p.z())) > 1.9) {
      continue;
    }
    ASSERT_EQ(point.kind, reference::SurfaceKind::plane);
    planes += 1;
    worst = std::max(worst, (point.direction + Eigen::Vector3d::UnitX()).norm());
  }
  EXPECT_GT(planes, 1000);
  EXPECT_LT(worst, 0.5 / 57.3);
  RecordProperty("worst normal, degrees", std::to_string(worst * 57.3));
}

// Rings of a sensor with few beams are farther apart on the ground than its cells are wide.
TEST_F(PreprocessKernels, RingsOnTheGroundShowItWhereACellHoldsOneOfThem) {
  constexpr double kHeight = 1.8;
  Random random(12);
  std::vector<Point> raw;
  for (int beam = 0; beam < 8; ++beam) {
    const double elevation = (-15.0 + 2.0 * beam) / 57.29578;
    for (int column = 0; column < 1800; ++column) {
      const double azimuth = 2.0 * 3.14159265 * column / 1800.0;
      const double range = -kHeight / std::sin(elevation) + 0.01 * random.gaussian();
      raw.push_back({static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)),
                     static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)),
                     static_cast<float>(range * std::sin(elevation)), 0.0F});
    }
  }
  const engine::PreprocessSettings settings{
      .c_min = 0.5, .c_max = 100.0, .r_input = 0.2, .beam_spacing = 2.0 / 57.29578};
  PreprocessRun run(context(), settings, raw);
  run.run();
  int near = 0;
  int planes = 0;
  for (const reference::SurfacePoint& point : reference::decode(run.surface_cloud())) {
    if (point.p.norm() < 12.0) {
      near += 1;
      planes += reference::is_plane(point.kind) && point.direction.z() > 0.9986 ? 1 : 0;
    }
  }
  RecordProperty("points within 12 m", near);
  RecordProperty("on the ground", planes);
  EXPECT_GT(planes, 0.95 * near);
}

TEST_F(PreprocessKernels, TwoRunsGiveTheSameBytesAndLeaveTheScratchClean) {
  for (const SweepCase& sweep : test::sweep_cases()) {
    SCOPED_TRACE(sweep.name);
    PreprocessRun run(context(), sweep.settings, sweep.raw);
    run.run();
    const std::vector<Point> cloud = run.cloud();
    const std::vector<gpu::uvec4> surface_cloud = run.surface_cloud();
    for (int again = 0; again < 2; ++again) {
      run.run();  // the same scratch, not reset
      EXPECT_TRUE(same_bytes(run.cloud(), cloud));
      EXPECT_TRUE(same_bytes(run.surface_cloud(), surface_cloud));
    }
  }
}

TEST_F(PreprocessKernels, OrderOfThePointsChangesOnlyTheOrderOfTheCloud) {
  for (const SweepCase& sweep : test::sweep_cases()) {
    SCOPED_TRACE(sweep.name);
    PreprocessRun run(context(), sweep.settings, sweep.raw);
    run.run();
    PreprocessRun other(context(), sweep.settings, shuffled(sweep.raw, 17));
    other.run();
    EXPECT_EQ(other.counters().valid_points, run.counters().valid_points);
    EXPECT_EQ(by_position(other.surface_cloud()), by_position(run.surface_cloud()));
  }
}

// A sum of 32 bits holds 65 535 points for certain; beyond that it carries.
TEST_F(PreprocessKernels, ACrowdedCellKeepsItsMean) {
  for (const size_t count : {65'535UL, 65'536UL, 140'000UL, 1'000'000UL}) {
    SCOPED_TRACE(count);
    // Near the upper corner, where the sums are largest, and one elsewhere. Each axis carries
    // another number of times, and runs of every length do.
    std::vector<Point> raw(count, Point{3.2499F, 2.2499F, 1.2499F, 5.0F});
    raw[0] = {3.12F, 2.13F, 1.14F, 7.0F};
    raw.push_back({-3.21F, 2.34F, 1.23F, 2.0F});
    for (size_t i = 1; i < count / 2; i += 1 + i % 7) {
      raw[i] = {3.001F, 2.2499F, 1.12F, 5.0F};
    }
    const SweepCase sweep{"a crowded cell",
                          {.c_min = 0.5, .c_max = 100.0, .r_input = 0.25, .beam_spacing = 0.01},
                          raw};
    PreprocessRun run(context(), sweep.settings, sweep.raw);
    run.run();
    const Verdict verdict =
        test::verify_downsample(sweep.settings, sweep.raw, run.counters(), run.cloud());
    EXPECT_TRUE(verdict.passed()) << verdict.text();
    const std::vector<Point> cloud = run.cloud();
    run.run();
    EXPECT_TRUE(same_bytes(run.cloud(), cloud));
  }
}

// Points of a wall, one a voxel of 2 cm, in one surface cell.
std::vector<Point> fine_wall(size_t count) {
  std::vector<Point> raw;
  for (size_t i = 0; i < count; ++i) {
    raw.push_back({8.01F, 1.01F + 0.02F * static_cast<float>(i % 300),
                   1.01F + 0.02F * static_cast<float>(i / 300), 0.0F});
  }
  return raw;
}

TEST_F(PreprocessKernels, ASurfaceCellWithMorePointsThanItsSumsHoldShowsNone) {
  const engine::PreprocessSettings settings{
      .c_min = 0.5, .c_max = 100.0, .r_input = 0.02, .beam_spacing = 0.01, .surface_size = 16.0};
  for (const uint32_t beyond : {0U, 1U, 20'000U}) {
    SCOPED_TRACE(beyond);
    PreprocessRun run(context(), settings, fine_wall(gpu::kMostCellPoints + beyond));
    run.run();
    ASSERT_EQ(run.counters().cloud_points, gpu::kMostCellPoints + beyond);
    // A point is in a cell and in one that is twice as wide.
    EXPECT_EQ(run.counters().surface_failures, 2 * beyond);
    size_t planes = 0;
    for (const reference::SurfacePoint& point : reference::decode(run.surface_cloud())) {
      planes += reference::is_plane(point.kind) && std::abs(point.direction.x()) > 0.999 ? 1U : 0U;
    }
    EXPECT_EQ(planes, beyond == 0 ? gpu::kMostCellPoints : 0U);
  }
}

TEST_F(PreprocessKernels, EverySizeAroundRunsAndGroupsIsWhole) {
  // One point a cell, so that a point that some thread forgets or takes twice is seen.
  std::vector<Point> raw;
  for (int i = 0; i < 5000; ++i) {
    raw.push_back({2.0F + static_cast<float>(i % 70), static_cast<float>(i / 70), 1.0F,
                   static_cast<float>(i)});
  }
  const engine::PreprocessSettings settings{
      .c_min = 0.5, .c_max = 200.0, .r_input = 0.5, .beam_spacing = 0.01};
  for (const size_t size : {1UL, 3UL, 4UL, 5UL, 15UL, 16UL, 17UL, 63UL, 64UL, 65UL, 127UL, 129UL,
                            1023UL, 1024UL, 1025UL, 4095UL, 4097UL}) {
    SCOPED_TRACE(size);
    const std::vector<Point> part(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    PreprocessRun run(context(), settings, part);
    run.run();
    const Verdict verdict = test::verify_downsample(settings, part, run.counters(), run.cloud());
    EXPECT_TRUE(verdict.passed()) << verdict.text();
  }
}

// Every point alone in its surface cell.
std::vector<Point> isolated_points(int count) {
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({static_cast<float>(i % 64) - 31.5F, static_cast<float>(i / 64 % 64) - 31.5F,
                      5.0F + static_cast<float>(i / 4096), 1.0F});
  }
  return shuffled(points, 3);
}

constexpr engine::PreprocessSettings kNarrow{
    .c_min = 0.5, .c_max = 100.0, .r_input = 0.3, .beam_spacing = 0.004};

TEST_F(PreprocessKernels, LongProbeChainsLoseNothing) {
  // Half of all slots of the smallest tables, so that chains of probes are long and threads of a
  // group leave their loops at different times. Two drivers hand a thread that has left a badly
  // written loop what an atomic returned to it while it was inactive (shaders/include/hash.glsl).
  const std::vector<Point> raw = isolated_points(512);
  PreprocessRun run(context(), kNarrow, raw);
  for (int again = 0; again < 5; ++again) {
    run.run();
    EXPECT_EQ(run.counters().surface_failures, 0U);
    const Verdict centroids = test::verify_downsample(kNarrow, raw, run.counters(), run.cloud());
    EXPECT_TRUE(centroids.passed()) << centroids.text();
    const Verdict surfaces = test::verify_surfaces(kNarrow, run.cloud(), run.surface_cloud());
    EXPECT_TRUE(surfaces.passed()) << surfaces.text();
  }
}

TEST_F(PreprocessKernels, PointsWithoutASurfaceCellAreCounted) {
  // More surface cells than the table may have slots for: what a point loses by that, it says.
  std::vector<Point> raw = isolated_points(13'000);
  const std::vector<Point> wall =
      test::random_points(2000, 8, {40.0, -5.0, -5.0}, {40.01, 5.0, 5.0});
  raw.insert(raw.end(), wall.begin(), wall.end());
  raw = shuffled(raw, 4);
  PreprocessRun run(context(), kNarrow, raw);
  run.run();
  Verdict centroids = test::verify_downsample(kNarrow, raw, run.counters(), run.cloud());
  EXPECT_TRUE(centroids.passed()) << centroids.text();
  Verdict surfaces = test::verify_surfaces(kNarrow, run.cloud(), run.surface_cloud());
  EXPECT_GT(surfaces.worst["normals compared"], 0.0);
  EXPECT_GT(run.counters().surface_failures, 0U);
  EXPECT_LE(surfaces.worst["wrong classes"], run.counters().surface_failures);
  RecordProperty("wrong classes", std::to_string(surfaces.worst["wrong classes"]));
  RecordProperty("surface failures", std::to_string(run.counters().surface_failures));
}

}  // namespace
}  // namespace adit
