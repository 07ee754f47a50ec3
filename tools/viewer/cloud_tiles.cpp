// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/cloud_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

namespace adit {
namespace {

constexpr std::size_t kLeafPoints = 12'000;  // fewer are not split
constexpr unsigned kDeepest = 16;  // below it a tile's 16 bits would be no bits of a place
constexpr std::size_t kMostInTile = 65'536;  // of points that no depth tells apart
constexpr std::size_t kWaiting = 65'536;
constexpr double kSteps = 4294967296.0;  // of the cube's edge
constexpr double kRoom = 1.001;
constexpr double kSmallest = 1e-3;  // m

std::size_t octant_of(const CubePoint& point, unsigned level) {
  const unsigned shift = 31U - level;
  return ((point.place[0] >> shift) & 1U) | (((point.place[1] >> shift) & 1U) << 1U) |
         (((point.place[2] >> shift) & 1U) << 2U);
}

/// The cell of a tile's grid that a point lies in.
std::size_t cell_of(const CubePoint& point, unsigned level) {
  std::size_t cell = 0;
  for (const uint32_t place : point.place) {
    cell = cell * kTileCells + ((place << level) >> 25U);
  }
  return cell;
}
static_assert(kTileCells == 1U << (32U - 25U));

}  // namespace

CloudCube cube_about(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const double edge = std::max(kRoom * (high - low).maxCoeff(), kSmallest);
  return {.low = 0.5 * (low + high) - Eigen::Vector3d::Constant(0.5 * edge), .edge = edge};
}

std::string tile_message(uint32_t number, std::span<const TilePoint> points,
                         std::span<const PointColor> colors) {
  const std::array<uint32_t, 2> head = {number, static_cast<uint32_t>(points.size())};
  std::string message(sizeof(head) + points.size_bytes() + colors.size_bytes(), '\0');
  std::memcpy(message.data(), head.data(), sizeof(head));
  if (!points.empty()) {
    std::memcpy(message.data() + sizeof(head), points.data(), points.size_bytes());
  }
  if (!colors.empty()) {
    std::memcpy(message.data() + sizeof(head) + points.size_bytes(), colors.data(),
                colors.size_bytes());
  }
  return message;
}

std::vector<TilePoint> CloudTiles::read(uint32_t tile) const {
  const CloudTile& wanted = tiles_.at(tile);
  std::vector<TilePoint> points(wanted.points);
  store_->read(wanted.offset, std::as_writable_bytes(std::span(points)));
  return points;
}

std::vector<PointColor> CloudTiles::read_colors(uint32_t tile) const {
  const CloudTile& wanted = tiles_.at(tile);
  std::vector<PointColor> colors(colored_ ? wanted.points : 0);
  if (!colors.empty()) {
    store_->read(wanted.offset + wanted.points * sizeof(TilePoint),
                 std::as_writable_bytes(std::span(colors)));
  }
  return colors;
}

CloudTilesMaker::CloudTilesMaker(const CloudCube& cube, std::size_t points_in_memory)
    : points_in_memory_(std::max(points_in_memory, kLeafPoints)),
      first_(std::make_unique<TemporaryFile>()) {
  made_.cube_ = cube;
  made_.store_ = std::make_unique<TemporaryFile>();
}

void CloudTilesMaker::add(const Eigen::Vector3d& position, const TilePointFacts& facts,
                          const PointColor& color) {
  if (!position.allFinite()) {
    return;
  }
  CubePoint point{.place = {}, .facts = facts, .color = color};
  made_.colored_ = made_.colored_ || color != PointColor{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double share = (position[i] - made_.cube_.low[i]) / made_.cube_.edge;
    point.place[k] = static_cast<uint32_t>(std::clamp(share * kSteps, 0.0, kSteps - 1.0));
  }
  waiting_.push_back(point);
  ++added_;
  if (waiting_.size() == kWaiting) {
    flush();
  }
}

void CloudTilesMaker::flush() {
  first_->write((added_ - waiting_.size()) * sizeof(CubePoint), std::as_bytes(std::span(waiting_)));
  waiting_.clear();
}

CloudTiles CloudTilesMaker::make(const std::function<void(uint64_t)>& progress) {
  progress_ = progress;
  flush();
  if (added_ > points_in_memory_) {
    second_ = std::make_unique<TemporaryFile>();
  }
  if (added_ > 0) {
    store(from_file(0, added_, 0, true), 0);
  }
  first_.reset();
  second_.reset();
  // Children were stored before their parents: turned round, the root is the first.
  std::vector<CloudTile>& tiles = made_.tiles_;
  const auto last = static_cast<int64_t>(tiles.size()) - 1;
  for (int64_t parent = 0; parent <= last; ++parent) {
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const int64_t child = stored_children_[static_cast<std::size_t>(parent)][octant];
      if (child >= 0) {
        tiles[static_cast<std::size_t>(child)].parent = static_cast<uint32_t>(last - parent);
        tiles[static_cast<std::size_t>(child)].octant = static_cast<uint8_t>(octant);
      }
    }
  }
  std::ranges::reverse(tiles);
  return std::move(made_);
}

/// Points in one of the two files. Those that are too many for memory are sorted by octant into the
/// other file, in the same place.
CloudTilesMaker::Tile CloudTilesMaker::from_file(uint64_t begin, uint64_t count, unsigned level,
                                                 bool in_first) {
  TemporaryFile& from = in_first ? *first_ : *second_;
  const auto piece_at = [&](uint64_t at, uint64_t most) {
    std::vector<CubePoint> piece(static_cast<std::size_t>(std::min(most, begin + count - at)));
    from.read(at * sizeof(CubePoint), std::as_writable_bytes(std::span(piece)));
    return piece;
  };
  if (count <= points_in_memory_ || level == kDeepest) {
    return from_memory(piece_at(begin, points_in_memory_), level);
  }
  std::array<uint64_t, 8> counts{};
  for (uint64_t at = begin; at < begin + count; at += kWaiting) {
    for (const CubePoint& point : piece_at(at, kWaiting)) {
      ++counts[octant_of(point, level)];
    }
  }
  std::array<uint64_t, 8> begins{};
  for (std::size_t octant = 0; octant < 8; ++octant) {
    begins[octant] = octant == 0 ? begin : begins[octant - 1] + counts[octant - 1];
  }
  TemporaryFile& into = in_first ? *second_ : *first_;
  std::array<uint64_t, 8> ends = begins;
  std::array<std::vector<CubePoint>, 8> sorted;
  for (uint64_t at = begin; at < begin + count; at += kWaiting) {
    for (const CubePoint& point : piece_at(at, kWaiting)) {
      sorted[octant_of(point, level)].push_back(point);
    }
    for (std::size_t octant = 0; octant < 8; ++octant) {
      into.write(ends[octant] * sizeof(CubePoint), std::as_bytes(std::span(sorted[octant])));
      ends[octant] += sorted[octant].size();
      sorted[octant].clear();
    }
  }
  std::array<Tile, 8> children;
  std::array<bool, 8> there{};
  for (std::size_t octant = 0; octant < 8; ++octant) {
    there[octant] = counts[octant] > 0;
    if (there[octant]) {
      children[octant] = from_file(begins[octant], counts[octant], level + 1, !in_first);
    }
  }
  return above(std::move(children), there, level);
}

CloudTilesMaker::Tile CloudTilesMaker::from_memory(std::vector<CubePoint> points, unsigned level) {
  if (points.size() <= kLeafPoints || level == kDeepest) {
    points.resize(std::min(points.size(), kMostInTile));
    return {.points = std::move(points)};
  }
  std::array<std::vector<CubePoint>, 8> sorted;
  for (const CubePoint& point : points) {
    sorted[octant_of(point, level)].push_back(point);
  }
  points = {};
  std::array<Tile, 8> children;
  std::array<bool, 8> there{};
  for (std::size_t octant = 0; octant < 8; ++octant) {
    there[octant] = !sorted[octant].empty();
    if (there[octant]) {
      children[octant] = from_memory(std::move(sorted[octant]), level + 1);
    }
  }
  return above(std::move(children), there, level);
}

/// The tile above those: one point of each of its cells, which the children lose. They are then
/// complete, and stored.
CloudTilesMaker::Tile CloudTilesMaker::above(std::array<Tile, 8> children,
                                             const std::array<bool, 8>& there, unsigned level) {
  Tile tile;
  std::vector<bool> taken(std::size_t{kTileCells} * kTileCells * kTileCells, false);
  for (std::size_t octant = 0; octant < 8; ++octant) {
    if (!there[octant]) {
      continue;
    }
    Tile& child = children[octant];
    std::erase_if(child.points, [&](const CubePoint& point) {
      const std::size_t cell = cell_of(point, level);
      if (taken[cell]) {
        return false;
      }
      taken[cell] = true;
      tile.points.push_back(point);
      return true;
    });
    const bool is_leaf = std::ranges::all_of(child.children, [](int64_t one) { return one < 0; });
    if (!child.points.empty() || !is_leaf) {
      tile.children[octant] = store(std::move(child), level + 1);
    }
  }
  return tile;
}

int64_t CloudTilesMaker::store(Tile tile, unsigned level) {
  std::vector<TilePoint> points;
  points.reserve(tile.points.size());
  for (const CubePoint& point : tile.points) {
    TilePoint& one = points.emplace_back(TilePoint{.place = {}, .facts = point.facts});
    for (std::size_t k = 0; k < 3; ++k) {
      one.place[k] = static_cast<uint16_t>((point.place[k] << level) >> 16U);
    }
  }
  made_.store_->write(bytes_, std::as_bytes(std::span(points)));
  made_.tiles_.push_back({.points = static_cast<uint32_t>(points.size()), .offset = bytes_});
  stored_children_.push_back(tile.children);
  bytes_ += points.size() * sizeof(TilePoint);
  if (made_.colored_) {
    std::vector<PointColor> colors;
    std::ranges::transform(tile.points, std::back_inserter(colors), &CubePoint::color);
    made_.store_->write(bytes_, std::as_bytes(std::span(colors)));
    bytes_ += colors.size() * sizeof(PointColor);
  }
  made_.points_ += points.size();
  if (progress_) {
    progress_(made_.points_);
  }
  return static_cast<int64_t>(made_.tiles_.size()) - 1;
}

}  // namespace adit
