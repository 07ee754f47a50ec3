// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The coordinates that products of a map are written in, and what they are called elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "adit/slam/gnss/world_frame.hpp"
#include "adit/tools/map_products/geoid.hpp"
#include "adit/tools/map_products/projected_system.hpp"

namespace adit {

/// A frame of x, y and z in metres.
enum class ProductFrame {
  map,    ///< as it was mapped
  local,  ///< WorldFrame: east, north and up of the georeference's origin
  utm,    ///< easting, northing, height
  named,  ///< the same in another projected system
};
/// The enumerator's name.
std::string_view to_string(ProductFrame frame);

/// "30N" and "30S". Nothing where it is no zone of UTM.
std::optional<UtmZone> parse_utm_zone(std::string_view text);
std::string to_string(const UtmZone& zone);
/// WGS 84 as OGC WKT 1.
std::string geographic_wkt();
/// 326zz or 327zz.
int epsg_of(const UtmZone& zone);
/// Of the georeference's origin, by the standard.
UtmZone zone_of(const Georeference& georeference);

/// A place of the map in all frames.
struct PlaceOnEarth {
  Eigen::Vector3d p_local = Eigen::Vector3d::Zero();  ///< m, WorldFrame
  Geodetic geodetic;
  UtmPosition utm;
};

/// What products in metres east and north are in.
struct ProductSystem {
  std::optional<UtmZone> zone{};           ///< none: that of the origin
  std::optional<ProjectedSystem> named{};  ///< of ProductFrame::named
  /// Heights of ProductFrame::utm and named are above it; none: above the ellipsoid.
  std::optional<Geoid> geoid{};
};

/// Coordinates of a product. A value; what a georeference says is worked out once.
class ProductCoordinates {
 public:
  /// Those of the map itself.
  ProductCoordinates() = default;
  /// Throws std::invalid_argument where UTM does not have the place, NoSuchSystem where the named
  /// system does not cover it.
  ProductCoordinates(const Georeference& georeference, ProductFrame frame,
                     const ProductSystem& system = {});

  ProductFrame frame() const { return frame_; }
  const UtmZone& zone() const { return zone_; }
  /// Needs a georeference.
  const WorldFrame& world() const { return world_.value(); }

  /// The same, counted from a place of this frame: nothing else of it changes.
  ProductCoordinates counted_from(const Eigen::Vector3d& place) const;
  /// The georeference's origin in this frame; 0 in the map's own.
  Eigen::Vector3d origin() const;

  /// A point of the map. In UTM within a micrometre of what place() gives: the projection, and the
  /// geoid, are interpolated within squares of a kilometre, since a cloud asks for it 100 million
  /// times. (Beyond 75 degrees of latitude within 20 micrometres.)
  Eigen::Vector3d from_map(const Eigen::Vector3d& p_map) const;
  /// A pose; in UTM and named systems its axes are those of the grid there.
  Eigen::Isometry3d from_map(const Eigen::Isometry3d& T_map_child) const;
  /// Without interpolation. Needs a georeference.
  PlaceOnEarth place(const Eigen::Vector3d& p_map) const;
  /// A point on Earth in the product's coordinates. Needs a georeference and not ProductFrame::map.
  Eigen::Vector3d from_geodetic(const Geodetic& place) const;

  /// The map's origin, rounded to kilometres, and to 100 m in height: what single precision and
  /// LAS files subtract. 0 in the map's own frame.
  Eigen::Vector3d offset() const;
  bool has_geoid() const { return geoid_.has_value(); }
  /// m above the geoid; nothing where none is given.
  std::optional<double> orthometric(const Geodetic& place) const;
  /// The plane's number in EPSG's register; nothing where it has none.
  std::optional<int> epsg() const;
  /// Of the plane, without the heights: "WGS 84 / UTM zone 30N". Empty in the map's own frame.
  std::string plane_name() const;
  /// For people: "the map's frame", "WGS 84 / UTM zone 30N, heights above the ellipsoid".
  std::string name() const;
  /// The coordinate reference system as OGC WKT 1, of the plane alone or with the heights. Empty in
  /// the map's own frame.
  std::string plane_wkt() const;
  std::string wkt() const;

 private:
  using Square = std::pair<int64_t, int64_t>;
  /// East, north and the geoid's height less those of the square's middle at 3 x 3 places, and the
  /// middle.
  struct Patch {
    Eigen::Vector3d middle;
    std::array<Eigen::Vector3d, 9> nodes;
  };
  bool is_projected() const { return frame_ == ProductFrame::utm || frame_ == ProductFrame::named; }
  const Patch& patch(const Square& square) const;
  Eigen::Vector2d plane_at(const Geodetic& place) const;
  Eigen::Vector3d projected_at(const Eigen::Vector2d& p_local) const;
  double turn_at(const Eigen::Vector3d& p_local) const;

  ProductFrame frame_ = ProductFrame::map;
  Eigen::Isometry3d T_world_map_ = Eigen::Isometry3d::Identity();
  std::optional<WorldFrame> world_;
  UtmZone zone_;
  std::optional<ProjectedSystem> named_;
  std::optional<Geoid> geoid_;
  Eigen::Vector3d begin_ = Eigen::Vector3d::Zero();
  mutable std::map<Square, Patch> patches_;
};

}  // namespace adit
