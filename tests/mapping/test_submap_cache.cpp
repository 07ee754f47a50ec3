// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/submap_cache.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"

namespace adit {
namespace {

constexpr NodeId kStored = 8;

/// Points of a patch of 40 m by 40 m about a keyframe.
KeyframeSubmap patch(NodeId id, std::size_t points) {
  KeyframeSubmap submap;
  submap.r_submap = 0.25;
  submap.sweeps.push_back({.stamp = Nanoseconds(id), .merged = true});
  std::mt19937 random(static_cast<unsigned>(id) + 1);
  std::uniform_int_distribution<int32_t> wide(-20 * 2048, 20 * 2048);
  std::uniform_int_distribution<int32_t> flat(-512, 512);
  for (std::size_t i = 0; i < points; ++i) {
    submap.points.push_back({.place = {wide(random), wide(random), flat(random)}});
  }
  std::ranges::sort(submap.points, {}, &SubmapPoint::place);
  return submap;
}

class SubmapsInMemory : public testing::Test {
 protected:
  SubmapsInMemory() : map_(folder_ / "map.adit", MapAccess::write) {
    const SessionId session = test::add_session(map_);
    for (NodeId id = 0; id < kStored; ++id) {
      const double turn = 0.3 * static_cast<double>(id);
      const Eigen::Isometry3d pose = test::step(10.0 * static_cast<double>(id), 3.0) *
                                     Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
      map_.store({.keyframe = {.id = id, .session = session, .T_map_keyframe = pose},
                  .submap = encode(patch(id, 2000))});
    }
    size_ = memory_of(decode(map_.submap(0)));
  }

  const test::TemporaryFolder folder_;
  MapDatabase map_;
  uint64_t size_ = 0;
};

TEST_F(SubmapsInMemory, ThoseNeededLastStay) {
  SubmapCache cache(submap_loader(map_), 3 * size_ + size_ / 2);
  for (const NodeId id : {0, 1, 2, 0, 3}) {  // 1 has not been needed for longest
    EXPECT_EQ(cache.get(id)->points.size(), 2000U);
    EXPECT_LE(cache.bytes(), 3 * size_ + size_ / 2);
  }
  EXPECT_EQ(cache.reads(), 4U);
  for (const NodeId id : {0, 2, 3}) {
    static_cast<void>(cache.get(id));
  }
  EXPECT_EQ(cache.reads(), 4U);
  EXPECT_EQ(encode(*cache.get(1)).chunks, map_.submap(1).chunks);
  EXPECT_EQ(cache.reads(), 5U);
}

TEST_F(SubmapsInMemory, OneStaysHoweverLittleThereIsAndThoseInUseLive) {
  SubmapCache cache(submap_loader(map_), 1);
  const auto first = cache.get(0);
  static_cast<void>(cache.get(1));
  static_cast<void>(cache.get(1));
  EXPECT_EQ(cache.reads(), 2U);
  EXPECT_EQ(cache.bytes(), size_);
  EXPECT_EQ(first->points.size(), 2000U);
}

// The first point of each voxel in the order of keyframes, however the map is cut into tiles.
TEST_F(SubmapsInMemory, ACloudInTilesIsThatOfTheWholeMap) {
  for (const double resolution : {0.11, 0.5, 3.0}) {
    using CellIndex = std::tuple<int64_t, int64_t, int64_t>;
    std::map<CellIndex, Point> expected;
    for (const MapKeyframe& keyframe : map_.keyframes()) {
      for (const SubmapPoint& point : decode(map_.submap(keyframe.id)).points) {
        const Eigen::Vector3d p = keyframe.T_map_keyframe * point.position();
        const Eigen::Array3d cell = (p / resolution).array().floor();
        const Eigen::Vector3f single = p.cast<float>();
        expected.try_emplace({std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())},
                             Point{.x = single.x(), .y = single.y(), .z = single.z()});
      }
    }
    const auto sorted = [](std::vector<std::array<float, 3>> points) {
      std::ranges::sort(points);
      return points;
    };
    std::vector<std::array<float, 3>> whole;
    for (const auto& [voxel, point] : expected) {
      whole.push_back({point.x, point.y, point.z});
    }
    std::vector<std::array<float, 3>> tiled;
    std::size_t tiles = 0;
    visit_thinned_cloud(map_, resolution, 2 * size_, [&](std::span<const Point> points) {
      ++tiles;
      for (const Point& point : points) {
        tiled.push_back({point.x, point.y, point.z});
      }
    });
    EXPECT_EQ(sorted(tiled), sorted(whole)) << resolution;
    EXPECT_GT(tiles, resolution < 1.0 ? 1U : 0U);
  }
}

TEST_F(SubmapsInMemory, PlacesThatCannotBeAreToldAtOnce) {
  const SqliteDatabase raw(folder_ / "map.adit", SqliteDatabase::Mode::update);
  const auto visit = [&] { visit_thinned_cloud(map_, 0.1, size_, [](std::span<const Point>) {}); };
  raw.execute("UPDATE places SET max_x = 1e30 WHERE keyframe = 3");
  EXPECT_THROW(visit(), InputError);
  raw.execute("DELETE FROM places WHERE keyframe = 3");
  EXPECT_THROW(visit(), InputError);
}

// A keyframe far away costs no more than one nearby.
TEST_F(SubmapsInMemory, NothingIsAskedOfTheRoomBetweenFarPlaces) {
  map_.revise({.poses = {{.id = 7, .T_map_node = test::step(5e6, -7e6)}}});
  std::size_t points = 0;
  visit_thinned_cloud(map_, 0.5, size_,
                      [&](std::span<const Point> tile) { points += tile.size(); });
  EXPECT_GT(points, 10'000U);
}

TEST_F(SubmapsInMemory, AnEmptyMapHasNoTiles) {
  const MapDatabase empty(folder_ / "empty.adit", MapAccess::write);
  EXPECT_TRUE(empty.boxes().empty());
  visit_thinned_cloud(empty, 0.1, 1000, [](std::span<const Point>) { FAIL(); });
}

}  // namespace
}  // namespace adit
