// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/cloud_tiles.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "adit/tests/support/environment.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/viewer/temporary_file.hpp"

namespace adit {
namespace {

struct Placed {
  Eigen::Vector3d p;
  TilePointFacts facts;
};

/// Points on three walls and in a heap, each with facts that number it.
std::vector<Placed> points(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Placed> all;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d p(40.0 * share(random), 30.0 * share(random), 5.0 * share(random));
    if (i % 4 < 3) {
      p[static_cast<Eigen::Index>(i % 4)] = 1.0;
    } else {
      p = Eigen::Vector3d(20.0, 15.0, 2.0) + 1e-3 * p;
    }
    all.push_back({.p = p,
                   .facts = {.moment = static_cast<uint16_t>(i & 0xffffU),
                             .keyframe = static_cast<uint16_t>(i >> 16U),
                             .intensity = static_cast<uint8_t>(i % 256),
                             .flags = static_cast<uint8_t>(i % 2)}});
  }
  return all;
}

CloudTiles tiles_of(const std::vector<Placed>& all, std::size_t in_memory) {
  CloudTilesMaker maker(cube_about({0.0, 0.0, 0.0}, {40.0, 30.0, 5.0}), in_memory);
  for (const Placed& one : all) {
    maker.add(one.p, one.facts);
  }
  return maker.make();
}

/// The cube of each tile, by those above it.
std::vector<CloudCube> cubes_of(const CloudTiles& tiles) {
  std::vector<CloudCube> cubes;
  for (const CloudTile& tile : tiles.tiles()) {
    if (cubes.empty()) {
      cubes.push_back(tiles.cube());
      continue;
    }
    CloudCube cube = cubes.at(tile.parent);
    cube.edge *= 0.5;
    cube.low +=
        cube.edge * Eigen::Vector3d(tile.octant & 1, (tile.octant >> 1) & 1, tile.octant >> 2);
    cubes.push_back(cube);
  }
  return cubes;
}

TEST(CloudTiles, HaveEveryPointOnceWhereItWas) {
  constexpr std::size_t kCount = 200'000;
  const std::vector<Placed> all = points(kCount);
  const CloudTiles tiles = tiles_of(all, kCount);
  EXPECT_EQ(tiles.points(), kCount);
  EXPECT_GT(tiles.tiles().size(), 20U);
  const std::vector<CloudCube> cubes = cubes_of(tiles);
  std::vector<int> seen(kCount, 0);
  for (uint32_t number = 0; number < tiles.tiles().size(); ++number) {
    const std::vector<TilePoint> read = tiles.read(number);
    ASSERT_EQ(read.size(), tiles.tiles()[number].points);
    const double step = cubes[number].edge / 65536.0;
    for (const TilePoint& point : read) {
      const std::size_t i = point.facts.moment + (std::size_t{point.facts.keyframe} << 16U);
      ASSERT_LT(i, kCount);
      ++seen[i];
      const Eigen::Vector3d place(point.place[0], point.place[1], point.place[2]);
      const Eigen::Vector3d p = cubes[number].low + step * (place.array() + 0.5).matrix();
      ASSERT_LT((p - all[i].p).cwiseAbs().maxCoeff(), 0.51 * step) << i;
      ASSERT_EQ(point.facts.intensity, i % 256);
      ASSERT_EQ(point.facts.flags, i % 2);
    }
  }
  EXPECT_TRUE(std::ranges::all_of(seen, [](int count) { return count == 1; }));
}

TEST(CloudTiles, AreTheSameWhereTheyDoNotFitIntoMemory) {
  const std::vector<Placed> all = points(150'000);
  const CloudTiles inside = tiles_of(all, 150'000);
  const CloudTiles outside = tiles_of(all, 20'000);
  ASSERT_EQ(inside.tiles().size(), outside.tiles().size());
  for (uint32_t number = 0; number < inside.tiles().size(); ++number) {
    EXPECT_EQ(inside.tiles()[number].parent, outside.tiles()[number].parent);
    EXPECT_EQ(inside.tiles()[number].octant, outside.tiles()[number].octant);
    const auto order = [](const TilePoint& a, const TilePoint& b) {
      return std::tie(a.facts.keyframe, a.facts.moment) <
             std::tie(b.facts.keyframe, b.facts.moment);
    };
    std::vector<TilePoint> a = inside.read(number);
    std::vector<TilePoint> b = outside.read(number);
    std::ranges::sort(a, order);
    std::ranges::sort(b, order);
    EXPECT_TRUE(std::ranges::equal(a, b, [](const TilePoint& one, const TilePoint& other) {
      return one.place == other.place && one.facts.moment == other.facts.moment;
    })) << number;
  }
}

TEST(CloudTiles, PointsKeepTheirColors) {
  constexpr std::size_t kCount = 30'000;
  const std::vector<Placed> all = points(kCount);
  const auto color_of = [](std::size_t i) {
    return PointColor{static_cast<uint8_t>(i % 256), static_cast<uint8_t>(i / 256), 7};
  };
  CloudTilesMaker maker(cube_about({0.0, 0.0, 0.0}, {40.0, 30.0, 5.0}));
  for (std::size_t i = 0; i < kCount; ++i) {
    maker.add(all[i].p, all[i].facts, color_of(i));
  }
  const CloudTiles tiles = maker.make();
  EXPECT_TRUE(tiles.colored());
  for (uint32_t number = 0; number < tiles.tiles().size(); ++number) {
    const std::vector<TilePoint> read = tiles.read(number);
    const std::vector<PointColor> colors = tiles.read_colors(number);
    ASSERT_EQ(colors.size(), read.size());
    for (std::size_t k = 0; k < read.size(); ++k) {
      ASSERT_EQ(colors[k], color_of(read[k].facts.moment));
    }
    EXPECT_EQ(tile_message(number, read, colors).size(),
              8 + read.size() * (sizeof(TilePoint) + sizeof(PointColor)));
  }
  const CloudTiles without = tiles_of(all, kCount);
  EXPECT_FALSE(without.colored());
  EXPECT_TRUE(without.read_colors(0).empty());
}

TEST(CloudTiles, AnInnerTileIsACloudThinnedToItsCells) {
  const CloudTiles tiles = tiles_of(points(200'000), 200'000);
  std::set<uint32_t> parents;
  for (uint32_t number = 1; number < tiles.tiles().size(); ++number) {
    EXPECT_LT(tiles.tiles()[number].parent, number);
    parents.insert(tiles.tiles()[number].parent);
  }
  for (const uint32_t number : parents) {
    std::set<std::array<int, 3>> cells;
    for (const TilePoint& point : tiles.read(number)) {
      cells.insert({point.place[0] >> 9, point.place[1] >> 9, point.place[2] >> 9});
    }
    // Those that its parent took are missing; no cell has two.
    EXPECT_EQ(cells.size(), tiles.tiles()[number].points) << number;
  }
}

TEST(TemporaryFile, NamesThePlaceThatIsNone) {
  const test::Variable temporary("TMPDIR", "/nonexistent");
  try {
    TemporaryFile file;
    FAIL() << "made elsewhere";
  } catch (const OutputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("/nonexistent: nothing temporary"))
        << error.what();
  }
}

TEST(CloudTiles, OfNothingAreNone) {
  EXPECT_TRUE(tiles_of({}, 1000).tiles().empty());
  CloudTilesMaker maker(cube_about(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()));
  maker.add(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), {});
  EXPECT_EQ(maker.added(), 0U);
  EXPECT_TRUE(maker.make().tiles().empty());
}

TEST(CloudTiles, PointsThatNothingTellsApartAreBounded) {
  CloudTilesMaker maker(cube_about({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}), 50'000);
  for (int i = 0; i < 200'000; ++i) {
    maker.add({0.3, 0.3, 0.3}, {});
  }
  const CloudTiles tiles = maker.make();
  EXPECT_GT(tiles.points(), 0U);
  for (const CloudTile& tile : tiles.tiles()) {
    EXPECT_LE(tile.points, 65'536U);
  }
}

TEST(CloudTiles, ReadOfATileThatIsNoneThrows) {
  EXPECT_THROW(tiles_of(points(10), 1000).read(1), std::out_of_range);
}

}  // namespace
}  // namespace adit
