// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/surface_from_above.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/map_tiles.hpp"

namespace adit {
namespace {

// A tile has as many cells as a block of a GeoTIFF, but is no wider than what one sweep's views
// are chosen for.
constexpr int64_t kMostAcross = 256;
constexpr double kWidestTile = 25.6;  // m
// Steeper planes are walls: from above they are lines.
constexpr double kSteepest = 0.17;  // cosine of 80 degrees

/// Interleaved bits of both numbers (Morton 1966): neighbours are mostly close to each other.
uint64_t order_of(const TileNumber& tile) {
  uint64_t order = 0;
  const auto x = static_cast<uint64_t>(tile.x) + (uint64_t{1} << 31U);
  const auto y = static_cast<uint64_t>(tile.y) + (uint64_t{1} << 31U);
  for (unsigned bit = 0; bit < 32; ++bit) {
    order |= ((x >> bit) & 1U) << (2 * bit) | ((y >> bit) & 1U) << (2 * bit + 1);
  }
  return order;
}

/// A surfel in the product's coordinates.
struct Disc {
  Eigen::Vector3d p;  // m
  Eigen::Vector3d normal;
  double radius = 0.0;  // m
};

/// Heights of one tile's places: each is the mean of the discs there that lie within their radius
/// of the highest, weighted by how near their centres are. The highest alone would be the one with
/// the largest error.
class TileSurface {
 public:
  TileSurface(const TileNumber& tile, const TileGrid& grid)
      : step_(grid.cell / static_cast<double>(kPlacesAcross)),
        side_(grid.across * kPlacesAcross),
        low_(step_ * static_cast<double>(side_) *
             Eigen::Vector2d(static_cast<double>(tile.x), static_cast<double>(tile.y))),
        places_(static_cast<std::size_t>(side_ * side_)) {}

  /// Whether a disc about that place may reach into the tile.
  bool is_near(const Eigen::Vector3d& p, double radius) const {
    const Eigen::Array2d within = (p.head<2>() - low_).array();
    return (within > -radius).all() && (within < radius + step_ * static_cast<double>(side_)).all();
  }

  void add(const Disc& disc) {
    const Eigen::Vector2d at = (disc.p.head<2>() - low_) / step_;
    const double reach = disc.radius / step_;
    const auto from = [&](double value) {
      return std::max<int64_t>(0, std::lround(std::ceil(value - reach - 0.5)));
    };
    const auto until = [&](double value) {
      return std::min<int64_t>(side_ - 1, std::lround(std::floor(value + reach - 0.5)));
    };
    for (int64_t y = from(at.y()); y <= until(at.y()); ++y) {
      for (int64_t x = from(at.x()); x <= until(at.x()); ++x) {
        const Eigen::Vector2d aside = place(x, y) - disc.p.head<2>();
        const double up = -disc.normal.head<2>().dot(aside) / disc.normal.z();
        const double share = (aside.squaredNorm() + up * up) / (disc.radius * disc.radius);
        if (share < 1.0) {
          add(x, y, disc.p.z() + up, 1.0 - share, disc.radius);
        }
      }
    }
  }

  Eigen::Vector2d place(int64_t x, int64_t y) const {
    return low_ +
           step_ * Eigen::Vector2d(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
  }

  /// Calls act(place) for each place with a surface, cell by cell; product frame, m.
  void for_each(const auto& act) const {
    constexpr int64_t kPlaces = kPlacesAcross * kPlacesAcross;
    for (int64_t i = 0; i < side_ * side_; ++i) {
      const int64_t cell = i / kPlaces;
      const int64_t across = side_ / kPlacesAcross;
      const int64_t x = cell % across * kPlacesAcross + i % kPlacesAcross;
      const int64_t y = cell / across * kPlacesAcross + i % kPlaces / kPlacesAcross;
      const Place& one = places_[static_cast<std::size_t>(y * side_ + x)];
      if (one.weight > 0.0) {
        const Eigen::Vector2d at = place(x, y);
        act(Eigen::Vector3d(at.x(), at.y(), one.sum / one.weight));
      }
    }
  }

 private:
  struct Place {
    double highest = 0.0;  // m
    double sum = 0.0;
    double weight = 0.0;
  };

  void add(int64_t x, int64_t y, double height, double weight, double within) {
    Place& one = places_[static_cast<std::size_t>(y * side_ + x)];
    if (one.weight > 0.0 && height < one.highest - within) {
      return;
    }
    if (one.weight == 0.0 || height > one.highest + within) {
      one = {.highest = height};
    }
    one.highest = std::max(one.highest, height);
    one.sum += weight * height;
    one.weight += weight;
  }

  double step_;   // m
  int64_t side_;  // places along it
  Eigen::Vector2d low_;
  std::vector<Place> places_;
};

/// From a product's coordinates back to the map's, near a place: as affine. Over a tile, the
/// Earth's curvature is less than a tenth of a millimetre.
class BackToMap {
 public:
  BackToMap(const ProductCoordinates& coordinates, const Eigen::Vector3d& product,
            const Eigen::Vector3d& near_in_map)
      : in_map_(near_in_map) {
    constexpr int kSteps = 3;  // Newton's: each squares an error of some 1e-4
    for (int step = 0; step < kSteps; ++step) {
      in_product_ = coordinates.from_map(in_map_);
      Eigen::Matrix3d turn;
      for (Eigen::Index k = 0; k < 3; ++k) {
        turn.col(k) =
            coordinates.from_map(Eigen::Vector3d(in_map_ + Eigen::Vector3d::Unit(k))) - in_product_;
      }
      back_ = turn.inverse();
      in_map_ += back_ * (product - in_product_);
    }
    in_product_ = coordinates.from_map(in_map_);
  }

  Eigen::Vector3d operator()(const Eigen::Vector3d& product) const {
    return in_map_ + back_ * (product - in_product_);
  }

 private:
  Eigen::Vector3d in_map_;
  Eigen::Vector3d in_product_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d back_ = Eigen::Matrix3d::Identity();
};

/// The side of a surfel that was seen, in the keyframe's axes; upright where it is no plane.
/// Nothing where that is not its upper side.
std::optional<Eigen::Vector3d> upper_side(const SubmapPoint& measured,
                                          const Eigen::Vector3d& to_sensor,
                                          const Eigen::Matrix3d& R_product_keyframe) {
  if (!has_direction(measured.surface) || !is_plane(measured.surface)) {
    return R_product_keyframe.row(2).dot(to_sensor) > 0.0
               ? std::optional<Eigen::Vector3d>(Eigen::Vector3d::UnitZ())
               : std::nullopt;
  }
  const Eigen::Vector3d direction = surface_direction(measured.surface);
  const Eigen::Vector3d normal =
      R_product_keyframe * (direction.dot(to_sensor) < 0.0 ? -direction : direction);
  return normal.z() < kSteepest ? std::nullopt : std::optional(normal);
}

/// The surfels of a submap that show their upper side, without what moves.
void add_submap(const MapKeyframe& keyframe, const KeyframeSubmap& submap,
                const ProductCoordinates& coordinates, const CloudSelection& selection,
                TileSurface& surface) {
  const Eigen::Matrix3d R_product_keyframe = coordinates.from_map(keyframe.T_map_keyframe).linear();
  // Half the diagonal of a voxel's face: on a plane, neighbouring discs leave no hole.
  const double radius = submap.r_submap / std::numbers::sqrt2;
  for (const SubmapPoint& measured : submap.points) {
    if (measured.seen_through || measured.sweep >= submap.sweeps.size()) {
      continue;
    }
    const Eigen::Vector3d p_map = keyframe.T_map_keyframe * measured.position();
    const Eigen::Vector3d p = coordinates.from_map(p_map);
    const SubmapSweep& sweep = submap.sweeps[measured.sweep];
    if (!surface.is_near(p, radius) || !is_wanted(selection, keyframe.session, sweep.stamp) ||
        has_moved(selection, p_map) ||
        (selection.is_gone && selection.is_gone(p_map, keyframe.session))) {
      continue;
    }
    const Eigen::Vector3d to_sensor = sweep.T_keyframe_lidar.translation() - measured.position();
    if (const auto normal = upper_side(measured, to_sensor, R_product_keyframe)) {
      surface.add({.p = p, .normal = *normal, .radius = radius});
    }
  }
}

}  // namespace

void visit_surface_from_above(const MapDatabase& map, const ProductCoordinates& coordinates,
                              const CloudSelection& selection, double cell, uint64_t submap_bytes,
                              const TakeSurface& take) {
  const TileGrid grid{
      .cell = cell, .across = std::clamp<int64_t>(std::lround(kWidestTile / cell), 1, kMostAcross)};
  const auto by_tile = keyframes_by_tile(map, coordinates, selection, grid);
  std::vector<TileNumber> tiles;
  for (const auto& [tile, keyframes] : by_tile) {
    tiles.push_back(tile);
  }
  std::ranges::sort(tiles, {}, order_of);
  SubmapCache cache(submap_loader(map), submap_bytes);
  std::size_t done = 0;
  for (const TileNumber& tile : tiles) {
    TileSurface surface(tile, grid);
    const std::vector<MapKeyframe>& keyframes = by_tile.at(tile);
    for (const MapKeyframe& keyframe : keyframes) {
      const auto submap = load_submap(cache, keyframe.id, map.file());
      add_submap(keyframe, *submap, coordinates, selection, surface);
    }
    std::vector<CloudPoint> points;
    Eigen::AlignedBox3d box;
    surface.for_each([&](const Eigen::Vector3d& place) {
      if (selection.polygon.empty() || is_within(selection.polygon, place.head<2>())) {
        points.push_back({.position = place});
        box.extend(place);
      }
    });
    ++done;
    if (points.empty()) {
      continue;
    }
    const BackToMap back(coordinates, box.center(), keyframes.front().T_map_keyframe.translation());
    for (CloudPoint& point : points) {
      point.in_map = back(point.position);
    }
    take({.points = points, .middle = back(box.center())}, done, tiles.size());
  }
}

}  // namespace adit
