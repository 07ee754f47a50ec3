// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Volumes of surfaces that are known, and `adit volume` of a map with two sessions between which a
// heap is put on the ground.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/plans/mapped_house.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_volume.hpp"
#include "adit/tools/plans/ground_volume.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::Ran;
using test::ran;

constexpr double kHeapHeight = 1.5;  // m
constexpr double kHeapRadius = 2.5;  // m
constexpr double kVolumeOfHeap = 3.14159265358979 * kHeapRadius * kHeapRadius * kHeapHeight / 3.0;

double heap(double x, double y) {
  return std::max(0.0, kHeapHeight * (1.0 - std::hypot(x, y) / kHeapRadius));
}

/// 24 x 24 m in cells of 0.25 m, with noise of `sigma` (m) a cell and `offset` (m).
GroundHeights heights_of(const std::function<double(double, double)>& at, double sigma,
                         double offset, uint64_t seed) {
  Random random(seed);
  GroundHeights heights(0.25);
  for (int64_t y = -48; y < 48; ++y) {
    for (int64_t x = -48; x < 48; ++x) {
      const Vector2d p = heights.middle({y, x});
      heights.set({y, x}, at(p.x(), p.y()) + offset + sigma * random.gaussian());
    }
  }
  return heights;
}

bool anywhere(const GroundHeights::Index& /*cell*/) {
  return true;
}

TEST(GroundVolume, OfANoisyHeapAgreesWithItsError) {
  // Of white noise the standard error is known: that of the sum of so many cells.
  constexpr double kSigma = 0.02;  // m, of a difference
  double squares = 0.0;
  constexpr int kTimes = 40;
  for (int seed = 1; seed <= kTimes; ++seed) {
    const GroundHeights difference = heights_of(heap, kSigma, 0.013, static_cast<uint64_t>(seed));
    const auto stable = stable_ground(difference);
    ASSERT_TRUE(stable);
    EXPECT_NEAR(stable->offset, 0.013, 0.002);
    EXPECT_NEAR(stable->spread, kSigma, 0.002);
    const GroundVolume volume = ground_volume(difference,
                                              {.stable = stable,
                                               .offset = stable->offset,
                                               .offset_error = stable->error_of_mean(stable->area),
                                               .square = 0.0625,
                                               .least_area = 1.0},
                                              anywhere);
    EXPECT_GT(volume.fill.area, 19.6) << "the heap";
    EXPECT_LT(volume.fill.area, 32.2) << "and 0.7 m around it";
    EXPECT_EQ(volume.cut.area, 0.0);
    EXPECT_NEAR(volume.fill.error, 0.0625 * kSigma * std::sqrt(volume.fill.area / 0.0625), 0.01);
    squares += std::pow((volume.fill.volume - kVolumeOfHeap) / volume.fill.error, 2);
  }
  // Between the quantiles of 0.1 % and 99.9 % of chi squared with 40 degrees of freedom, widened
  // at the top by what cells beside the heap lose or gain by being chosen.
  EXPECT_GT(squares, 17.9);
  EXPECT_LT(squares, 1.5 * 73.4);
}

TEST(GroundVolume, ErrorsOfNeighboursThatAgreeCountAsOne) {
  const GroundHeights white = heights_of([](double, double) { return 0.0; }, 0.02, 0.0, 3);
  // The same noise, but alike in squares of 2 m.
  GroundHeights blocks(0.25);
  Random random(4);
  std::map<GroundHeights::Index, double> of_block;
  for (const auto& [cell, height] : white.cells()) {
    const GroundHeights::Index block = {(cell[0] + 48) / 8, (cell[1] + 48) / 8};
    blocks.set(cell, of_block.try_emplace(block, 0.02 * random.gaussian()).first->second);
  }
  const auto alone = stable_ground(white);
  const auto alike = stable_ground(blocks);
  ASSERT_TRUE(alone && alike);
  EXPECT_NEAR(alone->error_of_mean(100.0), 0.02 * std::sqrt(0.0625 / 100.0), 2e-4);
  EXPECT_NEAR(alike->error_of_mean(100.0), 0.02 * std::sqrt(4.0 / 100.0), 1e-3);
  EXPECT_LE(alone->error_of_mean(1e4), alone->error_of_mean(1.0));
}

TEST(GroundVolume, NothingIsStableWhereAllHasChanged) {
  EXPECT_FALSE(stable_ground(
      heights_of([](double x, double y) { return 0.2 * x + 0.1 * y; }, 0.02, 0.0, 5)));
  EXPECT_FALSE(stable_ground(GroundHeights(0.25)));
}

TEST(GroundVolume, SmallGapsAreClosedAndCliffsAreNot) {
  GroundHeights ground(0.25);
  for (int64_t y = 0; y < 20; ++y) {
    for (int64_t x = 0; x < 20; ++x) {
      const bool is_gap = y >= 8 && y < 11;
      const bool is_wide = x >= 12;
      if (!is_gap && !(is_wide && y >= 6 && y < 13)) {
        ground.set({y, x}, x < 4 && y >= 11 ? 5.0 : 0.1 * static_cast<double>(y));
      }
    }
  }
  const ClosedGround closed = closed_gaps(ground);
  ASSERT_TRUE(closed.closed.contains({9, 8}));
  EXPECT_NEAR(*closed.heights.at({9, 8}), 0.9, 1e-9);
  EXPECT_FALSE(closed.closed.contains({9, 16})) << "too wide";
  EXPECT_FALSE(closed.closed.contains({9, 1})) << "a cliff of 4 m";
  EXPECT_FALSE(closed.closed.contains({3, 3})) << "that was seen";
}

/// Two sessions on flat ground of 24 x 24 m, walked around a place in the middle where the second
/// one has a heap.
class VolumeCommand : public testing::Test {
 protected:
  VolumeCommand() {
    MapDatabase map(map_, MapAccess::write);
    for (NodeId id = 0; id < 16; ++id) {
      const double angle = 2.0 * 3.14159265358979 * static_cast<double>(id % 8) / 8.0;
      if (id % 8 == 0) {
        session_ = map.add_session({.name = id == 0 ? "before" : "after"});
      }
      store(map, id, {6.0 * std::cos(angle), 6.0 * std::sin(angle), 0.0});
    }
  }

  void store(MapDatabase& map, NodeId id, const Vector3d& sensor) const {
    const std::chrono::seconds stamp(100 + 1000 * (id / 8) + id);
    KeyframeSubmap submap;
    submap.r_submap = 0.1;
    submap.vertical = Vertical::gravity;
    submap.sweeps = {{.stamp = stamp, .merged = true}};
    const double shift = 0.01 * static_cast<double>(id);
    for (double x = shift - 12.0; x < 12.0; x += 0.2) {
      for (double y = shift - 12.0; y < 12.0; y += 0.2) {
        const double height = id < 8 ? 0.0 : heap(x, y);
        const Vector3d slope(x, y, 0.0);
        const Vector3d normal =
            height > 0.0
                ? Vector3d(kHeapHeight / kHeapRadius * slope.normalized() + Vector3d::UnitZ())
                      .normalized()
                : Vector3d(Vector3d::UnitZ());
        // Each sees what is on its side.
        if ((Vector2d(x, y) - sensor.head<2>()).norm() < 9.0) {
          test::add_point(submap, sensor, {x, y, height - 1.5}, normal);
        }
      }
    }
    std::ranges::sort(submap.points, {}, &SubmapPoint::place);
    KeyframeRecord record{
        .keyframe = {.id = id,
                     .session = session_,
                     .stamp = stamp,
                     .T_map_keyframe = Eigen::Isometry3d(Eigen::Translation3d(sensor))},
        .submap = encode(submap)};
    if (id > 0) {
      record.edges.push_back({.from = id - 1, .to = id});
    }
    map.store(record);
  }

  Ran measured(VolumeCommandOptions options) const {
    options.maps = {map_};
    options.quiet = true;
    return ran(volume_command, options);
  }
  nlohmann::json report(VolumeCommandOptions options) const {
    options.json = true;
    const Ran done = measured(options);
    EXPECT_EQ(done.code, 0) << done.err;
    return nlohmann::json::parse(done.out);
  }
  void refuses(const VolumeCommandOptions& options, const char* what) const {
    const Ran done = measured(options);
    EXPECT_EQ(done.code, 2) << done.out;
    EXPECT_NE(done.err.find(what), std::string::npos) << done.err;
  }

  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
  SessionId session_ = 0;
};

TEST_F(VolumeCommand, BetweenSessionsIsThatOfTheHeap) {
  const nlohmann::json json = report({.raster = folder_ / "difference.tif"});
  EXPECT_EQ(json.at("base"), "sessions");
  EXPECT_NEAR(json.at("fill").at("volume_m3"), kVolumeOfHeap, 0.02 * kVolumeOfHeap);
  EXPECT_LT(json.at("cut").at("volume_m3"), 0.01);
  EXPECT_NEAR(json.at("stable").at("offset_m"), 0.0, 1e-3);
  EXPECT_LT(json.at("unseen_after_m2"), 0.01 * json.at("area_m2").get<double>());
  const std::string tiff = test::content(folder_ / "difference.tif");
  for (const char* band : {"difference", "before", "after"}) {
    EXPECT_NE(tiff.find(std::string("role=\"description\">") + band), std::string::npos);
  }
  const nlohmann::json back = report({.before = {2}, .after = {1}});
  EXPECT_NEAR(back.at("cut").at("volume_m3"), json.at("fill").at("volume_m3"), 1e-9);
  EXPECT_NEAR(back.at("net").at("volume_m3"), -json.at("net").at("volume_m3").get<double>(), 1e-9);
}

TEST_F(VolumeCommand, APolygonChoosesAndTheRestIsNotCounted) {
  VolumeCommandOptions half{};
  half.place.box = "0,-4,4,4";
  const nlohmann::json json = report(half);
  EXPECT_NEAR(json.at("fill").at("volume_m3"), 0.5 * kVolumeOfHeap, 0.02 * kVolumeOfHeap);
  EXPECT_NEAR(json.at("area_m2"), 32.0, 1e-9);
  half.place.box = "30,30,40,40";
  refuses(half, "no ground was seen both before and after");
}

TEST_F(VolumeCommand, AboveAPlaneOrTheSurroundings) {
  VolumeCommandOptions options{.after = {2}, .above = "surroundings"};
  options.place.box = "-3,-3,3,3";
  nlohmann::json json = report(options);
  EXPECT_EQ(json.at("base"), "surroundings");
  EXPECT_NEAR(json.at("fill").at("volume_m3"), kVolumeOfHeap, 0.02 * kVolumeOfHeap);
  EXPECT_NEAR(json.at("plane").at("height_m"), -1.5, 0.002);
  options.above = "-2";
  json = report(options);
  EXPECT_NEAR(json.at("fill").at("volume_m3"), kVolumeOfHeap + 0.5 * 36.0, 0.3);
  EXPECT_TRUE(json.at("fill").at("error_m3").is_null()) << "nothing says how high the map lies";
}

TEST_F(VolumeCommand, SaysWhatCannotBe) {
  refuses({.above = "surroundings"}, "say what heap it is");
  VolumeCommandOptions wrong{.above = "up"};
  wrong.place.box = "-3,-3,3,3";
  refuses(wrong, "expected a height");
  refuses({.before = {1}, .after = {1}}, "both before and after");
  refuses({.before = {7}}, "no such session");
  refuses({.raster = folder_ / "difference.png"}, "name it *.tif");
  refuses({.as_georeferenced = true}, "--as-georeferenced needs two maps");
  VolumeCommandOptions here{};
  here.place.frame = "utm";
  refuses(here, "not georeferenced");
}

}  // namespace
}  // namespace adit
