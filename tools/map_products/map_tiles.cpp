// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/map_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

// The index of places is in single precision, and rounds outwards; in coordinates that are turned
// and scaled a box is no box any more, by less than this share of it.
constexpr double kMargin = 1e-3;  // m
constexpr double kMarginShare = 1e-3;

int64_t floor_divided(int64_t number, int64_t by) {
  return number / by - static_cast<int64_t>(number % by < 0);
}

// Beyond this a box is no box of what a sensor has seen.
constexpr double kFarthest = 1e8;  // m
constexpr double kLargest = 1e4;   // m

bool is_possible(const Eigen::AlignedBox3d& box) {
  return (box.min().array().abs() < kFarthest).all() &&
         (box.max().array().abs() < kFarthest).all() && (box.sizes().array() < kLargest).all();
}

Eigen::AlignedBox2d box_in(const ProductCoordinates& coordinates, const Eigen::AlignedBox3d& box) {
  Eigen::AlignedBox2d plane;
  for (int corner = 0; corner < 8; ++corner) {
    const auto type = static_cast<Eigen::AlignedBox3d::CornerType>(corner);
    plane.extend(
        Eigen::Vector2d(coordinates.from_map(Eigen::Vector3d(box.corner(type))).head<2>()));
  }
  const double margin =
      kMargin +
      (coordinates.frame() == ProductFrame::map ? 0.0 : kMarginShare * plane.sizes().maxCoeff());
  return {plane.min() - Eigen::Vector2d::Constant(margin),
          plane.max() + Eigen::Vector2d::Constant(margin)};
}

}  // namespace

TileNumber TileGrid::tile_of(const Eigen::Vector2d& p) const {
  const auto number = [this](double coordinate) {
    return floor_divided(static_cast<int64_t>(std::floor(coordinate / cell)), across);
  };
  return {.y = number(p.y()), .x = number(p.x())};
}

std::map<NodeId, Eigen::AlignedBox3d> boxes_of_sight(const MapDatabase& map) {
  std::map<NodeId, Eigen::AlignedBox3d> sights;
  const std::map<NodeId, Eigen::AlignedBox3d> boxes = map.boxes();
  for (const MapKeyframe& keyframe : map.keyframes()) {
    const auto box = boxes.find(keyframe.id);
    Eigen::AlignedBox3d seen(keyframe.T_map_keyframe.translation());
    if (box != boxes.end()) {
      seen.extend(box->second);
    }
    if (box == boxes.end() || !is_possible(seen)) {
      throw InputError(
          map.file(), {},
          "submap " + std::to_string(keyframe.id) + " has no place, or none that is possible",
          "`adit check` says what else is wrong");
    }
    sights.emplace(keyframe.id, seen);
  }
  return sights;
}

void visit_tiles(const TileGrid& grid, const Eigen::AlignedBox2d& box,
                 const std::function<void(const TileNumber&)>& visit) {
  const TileNumber first = grid.tile_of(box.min());
  const TileNumber last = grid.tile_of(box.max());
  for (TileNumber tile = first; tile.y <= last.y; ++tile.y) {
    for (tile.x = first.x; tile.x <= last.x; ++tile.x) {
      visit(tile);
    }
  }
}

std::map<TileNumber, std::vector<MapKeyframe>> keyframes_by_tile(
    const MapDatabase& map, const ProductCoordinates& coordinates, const CloudSelection& selection,
    const TileGrid& grid) {
  std::map<TileNumber, std::vector<MapKeyframe>> tiles;
  const std::map<NodeId, Eigen::AlignedBox3d> sights = boxes_of_sight(map);
  for (const MapKeyframe& keyframe : map.keyframes()) {
    if (selection.sessions.empty() || selection.sessions.contains(keyframe.session)) {
      visit_tiles(grid, box_in(coordinates, sights.at(keyframe.id)),
                  [&](const TileNumber& tile) { tiles[tile].push_back(keyframe); });
    }
  }
  return tiles;
}

}  // namespace adit
