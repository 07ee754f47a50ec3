// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A cloud as an octree of tiles, of which a page gets those that it shows. A tile holds points of
// its cube, and its children hold others of theirs: who draws a tile draws those above it, too.
// Made with bounded memory, whatever the cloud's size; what does not fit lies in temporary files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/viewer/temporary_file.hpp"

namespace adit {

/// Of one edge of a tile's cube: each cell gives it at most one point, so that a tile's points are
/// about `edge / kTileCells` apart.
inline constexpr uint32_t kTileCells = 128;

/// The cube that a cloud lies in, map frame, m.
struct CloudCube {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  double edge = 1.0;
};
/// The smallest cube about a box, with some room.
CloudCube cube_about(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// Bits of TilePointFacts::flags.
inline constexpr uint8_t kMoves = 1;        ///< other sweeps saw through it
inline constexpr uint8_t kNoIntensity = 2;  ///< its intensity is not known

/// What the page gets of a point, besides its place.
struct TilePointFacts {
  uint16_t moment = 0;    ///< when: from 0, the first of the cloud, to 65535, the last
  uint16_t keyframe = 0;  ///< its position among the scene's
  uint8_t intensity = 0;  ///< from 0 to 255, what 98 of 100 points stay below
  uint8_t flags = 0;
};

using PointColor = std::array<uint8_t, 3>;  ///< red, green, blue; black: it has none

/// A point in a cube: places count 2^-32 of the edge.
struct CubePoint {
  std::array<uint32_t, 3> place{};
  TilePointFacts facts{};
  PointColor color{};
};
static_assert(sizeof(CubePoint) == 24);

/// A point as a page gets it, little-endian: places count 2^-16 of the edge of its tile's cube.
struct TilePoint {
  std::array<uint16_t, 3> place{};
  TilePointFacts facts{};
};
static_assert(sizeof(TilePoint) == 12);

/// What a page gets of a tile: its number and the number of its points (32 bits each), then the
/// points, and after them the colours of clouds that have some.
std::string tile_message(uint32_t number, std::span<const TilePoint> points,
                         std::span<const PointColor> colors = {});

/// The root comes first and is its own parent; every other tile comes after its parent.
struct CloudTile {
  uint32_t parent = 0;
  uint8_t octant = 0;  ///< bits 0, 1 and 2: the upper half of its parent in x, y and z
  uint32_t points = 0;
  uint64_t offset = 0;  ///< bytes, in the store
};

class CloudTiles {
 public:
  /// All tiles; empty for a cloud without points.
  std::span<const CloudTile> tiles() const { return tiles_; }
  const CloudCube& cube() const { return cube_; }
  uint64_t points() const { return points_; }
  /// Throws OutputError (the temporary file), std::out_of_range: no such tile.
  std::vector<TilePoint> read(uint32_t tile) const;

  /// Whether some point has a colour.
  bool colored() const { return colored_; }
  /// Those of a tile's points; empty where no point of the cloud has one. Throws as read() does.
  std::vector<PointColor> read_colors(uint32_t tile) const;

 private:
  friend class CloudTilesMaker;
  CloudCube cube_;
  bool colored_ = false;
  uint64_t points_ = 0;
  std::vector<CloudTile> tiles_;
  std::unique_ptr<TemporaryFile> store_;
};

/// Takes the points of a cloud in any order, then makes the tiles.
class CloudTilesMaker {
 public:
  /// `points_in_memory` bounds what is in memory at a time, 24 bytes each, several times over.
  /// Throws OutputError.
  explicit CloudTilesMaker(const CloudCube& cube, std::size_t points_in_memory = 1'000'000);

  /// A point outside of the cube is moved to its side, one that is not finite is left out. Throws
  /// OutputError: the disk is full.
  void add(const Eigen::Vector3d& position, const TilePointFacts& facts,
           const PointColor& color = {});
  uint64_t added() const { return added_; }

  /// Ends the maker. `progress` is called with the number of points that are in tiles. Throws
  /// OutputError.
  CloudTiles make(const std::function<void(uint64_t)>& progress = {});

 private:
  struct Tile {
    std::vector<CubePoint> points;
    std::array<int64_t, 8> children{-1, -1, -1, -1, -1, -1, -1, -1};
  };

  void flush();
  Tile from_file(uint64_t begin, uint64_t count, unsigned level, bool in_first);
  Tile from_memory(std::vector<CubePoint> points, unsigned level);
  Tile above(std::array<Tile, 8> children, const std::array<bool, 8>& there, unsigned level);
  int64_t store(Tile tile, unsigned level);

  std::size_t points_in_memory_;
  std::unique_ptr<TemporaryFile> first_;
  std::unique_ptr<TemporaryFile> second_;
  std::vector<CubePoint> waiting_;
  uint64_t added_ = 0;
  uint64_t bytes_ = 0;  ///< in the store
  std::vector<std::array<int64_t, 8>> stored_children_;
  std::function<void(uint64_t)> progress_;
  CloudTiles made_;
};

}  // namespace adit
