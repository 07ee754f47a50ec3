// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/foxglove_cloud_feed.hpp"

#include <span>

namespace adit {
namespace {

constexpr std::size_t kMostCloudPoints = 500'000;
constexpr double kPlacesOfTile = 65536.0;

/// A tile's cube, and how often it was halved.
struct TileCube {
  CloudCube cube;
  std::size_t level = 0;
};

std::vector<TileCube> cubes_of(const CloudTiles& tiles) {
  std::vector<TileCube> cubes;
  for (const CloudTile& tile : tiles.tiles()) {
    if (cubes.empty()) {
      cubes.push_back({.cube = tiles.cube()});
      continue;
    }
    TileCube cube = cubes[tile.parent];
    ++cube.level;
    cube.cube.edge *= 0.5;
    for (int k = 0; k < 3; ++k) {
      cube.cube.low[k] += (tile.octant >> k & 1) * cube.cube.edge;
    }
    cubes.push_back(cube);
  }
  return cubes;
}

/// How many levels have no more points than that, at least one.
std::size_t levels_within(std::span<const CloudTile> tiles, const std::vector<TileCube>& cubes,
                          std::size_t most) {
  std::vector<std::size_t> points;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    points.resize(std::max(points.size(), cubes[i].level + 1));
    points[cubes[i].level] += tiles[i].points;
  }
  std::size_t sum = 0;
  std::size_t levels = 0;
  while (levels < points.size() && (levels == 0 || sum + points[levels] <= most)) {
    sum += points[levels++];
  }
  return levels;
}

}  // namespace

std::vector<Point> points_of_tiles(const CloudTiles& tiles, std::size_t most) {
  const std::vector<TileCube> cubes = cubes_of(tiles);
  const std::size_t levels = levels_within(tiles.tiles(), cubes, most);
  std::vector<Point> points;
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    if (cubes[i].level >= levels) {
      continue;
    }
    for (const TilePoint& point : tiles.read(static_cast<uint32_t>(i))) {
      const Eigen::Array3d place(point.place[0], point.place[1], point.place[2]);
      const CloudCube& cube = cubes[i].cube;
      const Eigen::Vector3f p =
          (cube.low.array() + (place + 0.5) / kPlacesOfTile * cube.edge).matrix().cast<float>();
      points.push_back({.x = p.x(),
                        .y = p.y(),
                        .z = p.z(),
                        .intensity = static_cast<float>(point.facts.intensity)});
    }
  }
  return points;
}

FoxgloveCloudFeed::FoxgloveCloudFeed(const CloudTiles& tiles)
    : channels_{foxglove_channel(kMapPointsTopic)},
      message_(foxglove_message({kMapPointsTopic, Nanoseconds(0),
                                 point_cloud(Nanoseconds(0), kMapFrame, "intensity",
                                             points_of_tiles(tiles, kMostCloudPoints))})) {}

std::optional<uint64_t> FoxgloveCloudFeed::next(std::size_t /*channel*/, uint64_t after) {
  return after == 0 ? std::optional<uint64_t>(1) : std::nullopt;
}

FoxgloveMessage FoxgloveCloudFeed::message(std::size_t /*channel*/, uint64_t /*position*/) {
  return message_;
}

}  // namespace adit
