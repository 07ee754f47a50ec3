// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/product_coordinates.hpp"

#include <charconv>
#include <cmath>
#include <stdexcept>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"

namespace adit {
namespace {

// The projection's third derivatives are below 1e-13 / m^2: interpolated by a square polynomial
// it errs by less than a micrometre in squares of that size.
constexpr double kSquare = 1024.0;  // m
constexpr double kRound = 1000.0;   // m, of offsets
constexpr double kRoundHeight = 100.0;

constexpr std::string_view kGeographic =
    R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,)"
    R"(AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,)"
    R"(AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],)"
    R"(AUTHORITY["EPSG","4326"]])";
constexpr std::string_view kMetre = R"(UNIT["metre",1,AUTHORITY["EPSG","9001"]])";

std::string projected(const std::string& name, double latitude, double meridian, double scale,
                      double easting, double northing, const std::string& authority) {
  return fmt::format(
      R"(PROJCS["{}",{},PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",{}],)"
      R"(PARAMETER["central_meridian",{}],PARAMETER["scale_factor",{}],)"
      R"(PARAMETER["false_easting",{}],PARAMETER["false_northing",{}],{},)"
      R"(AXIS["Easting",EAST],AXIS["Northing",NORTH]{}])",
      name, kGeographic, shortest(latitude), shortest(meridian), shortest(scale), easting, northing,
      kMetre, authority);
}

/// Weights of the values at -1, 0 and 1 of a square polynomial.
std::array<double, 3> weights(double t) {
  return {0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)};
}

}  // namespace

std::string_view to_string(ProductFrame frame) {
  switch (frame) {
    case ProductFrame::map:
      return "map";
    case ProductFrame::local:
      return "local";
    case ProductFrame::utm:
      return "utm";
    case ProductFrame::named:
      return "named";
  }
  return "unknown";
}

std::optional<UtmZone> parse_utm_zone(std::string_view text) {
  UtmZone zone;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), zone.zone);
  const std::string_view rest = text.substr(static_cast<std::size_t>(end - text.data()));
  zone.north = rest == "N" || rest == "n";
  const bool south = rest == "S" || rest == "s";
  if (error != std::errc() || zone.zone < 1 || zone.zone > 60 || !(zone.north || south)) {
    return std::nullopt;
  }
  return zone;
}

std::string to_string(const UtmZone& zone) {
  return std::to_string(zone.zone) + (zone.north ? "N" : "S");
}

std::string geographic_wkt() {
  return std::string(kGeographic);
}

int epsg_of(const UtmZone& zone) {
  return (zone.north ? 32600 : 32700) + zone.zone;
}

UtmZone zone_of(const Georeference& georeference) {
  const UtmPosition utm = utm_of(georeference.origin);
  return {.zone = utm.zone, .north = utm.north};
}

ProductCoordinates::ProductCoordinates(const Georeference& georeference, ProductFrame frame,
                                       const ProductSystem& system)
    : frame_(frame),
      T_world_map_(georeference.T_world_map),
      world_(georeference.origin),
      zone_(system.zone ? *system.zone : zone_of(georeference)),
      named_(system.named),
      geoid_(system.geoid) {
  if (frame_ == ProductFrame::named && !named_) {
    throw std::logic_error("a frame by name needs its system");
  }
  static_cast<void>(plane_at(georeference.origin));
  static_cast<void>(orthometric(georeference.origin));
}

Eigen::Vector2d ProductCoordinates::plane_at(const Geodetic& place) const {
  if (frame_ == ProductFrame::named) {
    return named_->position_of(place);
  }
  const UtmPosition utm = utm_of(place, zone_);
  return {utm.easting, utm.northing};
}

Eigen::Vector3d ProductCoordinates::projected_at(const Eigen::Vector2d& p_local) const {
  const Geodetic place = world_->place_of({p_local.x(), p_local.y(), 0.0});
  const Eigen::Vector2d plane = plane_at(place);
  return {plane.x(), plane.y(), geoid_ ? geoid_->height_at(place) : 0.0};
}

/// Counter-clockwise, from the local frame's axes to the grid's.
double ProductCoordinates::turn_at(const Eigen::Vector3d& p_local) const {
  if (frame_ == ProductFrame::utm) {
    return utm_of(world_->place_of(p_local), zone_).convergence - world_->convergence_at(p_local);
  }
  constexpr double kStep = 10.0;  // m
  const auto at = [&](double north) {
    return plane_at(world_->place_of(p_local + Eigen::Vector3d(0.0, north, 0.0)));
  };
  const Eigen::Vector2d north = at(kStep) - at(-kStep);
  return std::atan2(-north.x(), north.y());
}

std::optional<double> ProductCoordinates::orthometric(const Geodetic& place) const {
  return geoid_ ? std::optional(geoid_->orthometric(place)) : std::nullopt;
}

const ProductCoordinates::Patch& ProductCoordinates::patch(const Square& square) const {
  const auto known = patches_.find(square);
  if (known != patches_.end()) {
    return known->second;
  }
  const Eigen::Vector2d middle =
      kSquare * Eigen::Vector2d(static_cast<double>(square.first) + 0.5,
                                static_cast<double>(square.second) + 0.5);
  Patch patch{.middle = projected_at(middle), .nodes = {}};
  for (std::size_t i = 0; i < 9; ++i) {
    const Eigen::Vector2d step(static_cast<double>(i % 3) - 1.0, static_cast<double>(i / 3) - 1.0);
    patch.nodes[i] = projected_at(middle + 0.5 * kSquare * step) - patch.middle;
  }
  return patches_.emplace(square, patch).first->second;
}

Eigen::Vector3d ProductCoordinates::from_map(const Eigen::Vector3d& p_map) const {
  if (frame_ == ProductFrame::map) {
    return p_map - begin_;
  }
  const Eigen::Vector3d p = T_world_map_ * p_map;
  if (frame_ == ProductFrame::local) {
    return p - begin_;
  }
  const Eigen::Vector2d place = p.head<2>() / kSquare;
  const Square square{static_cast<int64_t>(std::floor(place.x())),
                      static_cast<int64_t>(std::floor(place.y()))};
  const Patch& here = patch(square);
  const auto x = weights(2.0 * (place.x() - static_cast<double>(square.first)) - 1.0);
  const auto y = weights(2.0 * (place.y() - static_cast<double>(square.second)) - 1.0);
  Eigen::Vector3d projected = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 9; ++i) {
    projected += x[i % 3] * y[i / 3] * here.nodes[i];
  }
  projected += here.middle;
  const double height = p.z() + world_->origin().altitude - projected.z();
  return Eigen::Vector3d(projected.x(), projected.y(), height) - begin_;
}

Eigen::Isometry3d ProductCoordinates::from_map(const Eigen::Isometry3d& T_map_child) const {
  if (frame_ == ProductFrame::map) {
    return Eigen::Translation3d(-begin_) * T_map_child;
  }
  Eigen::Isometry3d pose = T_world_map_ * T_map_child;
  if (is_projected()) {
    pose.linear() = Eigen::AngleAxisd(turn_at(pose.translation()), Eigen::Vector3d::UnitZ())
                        .toRotationMatrix() *
                    pose.linear();
  }
  pose.translation() = from_map(Eigen::Vector3d(T_map_child.translation()));
  return pose;
}

PlaceOnEarth ProductCoordinates::place(const Eigen::Vector3d& p_map) const {
  PlaceOnEarth place{.p_local = T_world_map_ * p_map, .geodetic = {}, .utm = {}};
  place.geodetic = world_.value().place_of(place.p_local);
  place.utm = utm_of(place.geodetic, zone_);
  return place;
}

Eigen::Vector3d ProductCoordinates::from_geodetic(const Geodetic& place) const {
  if (frame_ == ProductFrame::local) {
    return world_.value().position_of(place);
  }
  const Eigen::Vector2d plane = plane_at(place);
  return {plane.x(), plane.y(), orthometric(place).value_or(place.altitude)};
}

ProductCoordinates ProductCoordinates::counted_from(const Eigen::Vector3d& place) const {
  ProductCoordinates counted = *this;
  counted.begin_ = place;
  return counted;
}

Eigen::Vector3d ProductCoordinates::origin() const {
  return is_projected() ? from_geodetic(world_->origin()) : Eigen::Vector3d::Zero();
}

Eigen::Vector3d ProductCoordinates::offset() const {
  if (frame_ == ProductFrame::map) {
    return Eigen::Vector3d::Zero();
  }
  const Eigen::Vector3d origin = from_map(Eigen::Vector3d(Eigen::Vector3d::Zero()));
  return {kRound * std::round(origin.x() / kRound), kRound * std::round(origin.y() / kRound),
          kRoundHeight * std::round(origin.z() / kRoundHeight)};
}

std::string ProductCoordinates::name() const {
  switch (frame_) {
    case ProductFrame::map:
      return "the map's frame";
    case ProductFrame::local: {
      const Geodetic& origin = world_->origin();
      return fmt::format("east, north and up of {:.9f}, {:.9f}, {:.3f} m", origin.latitude,
                         origin.longitude, origin.altitude);
    }
    case ProductFrame::utm:
    case ProductFrame::named:
      return plane_name() + (geoid_ ? ", heights above the geoid " + geoid_->name()
                                    : ", heights above the ellipsoid");
  }
  return {};
}

std::optional<int> ProductCoordinates::epsg() const {
  return frame_ == ProductFrame::utm     ? std::optional(epsg_of(zone_))
         : frame_ == ProductFrame::named ? named_->epsg()
                                         : std::nullopt;
}

std::string ProductCoordinates::plane_name() const {
  return frame_ == ProductFrame::utm     ? "WGS 84 / UTM zone " + to_string(zone_)
         : frame_ == ProductFrame::named ? named_->name()
         : frame_ == ProductFrame::local ? "WGS 84 / local transverse Mercator"
                                         : std::string();
}

std::string ProductCoordinates::plane_wkt() const {
  if (frame_ == ProductFrame::named) {
    return named_->wkt();
  }
  if (frame_ == ProductFrame::utm) {
    return projected(plane_name(), 0.0, 6.0 * zone_.zone - 183.0, 0.9996, 500000.0,
                     zone_.north ? 0.0 : 10000000.0,
                     fmt::format(R"(,AUTHORITY["EPSG","{}"])", epsg_of(zone_)));
  }
  if (frame_ == ProductFrame::local) {
    const Geodetic& origin = world_->origin();
    return projected(plane_name(), origin.latitude, origin.longitude, world_->scale(), 0.0, 0.0,
                     "");
  }
  return {};
}

std::string ProductCoordinates::wkt() const {
  if (frame_ == ProductFrame::map) {
    return {};
  }
  // 2005: heights above a geoid; 2002: above the ellipsoid; 2000: of another kind.
  const bool local = frame_ == ProductFrame::local;
  const std::string heights =
      local    ? fmt::format("Ellipsoidal height less {} m", shortest(world_->origin().altitude))
      : geoid_ ? "Height above the geoid " + geoid_->name()
               : std::string("Ellipsoidal height");
  const std::string datum = local    ? "Origin of the map"
                            : geoid_ ? geoid_->name() + " geoid"
                                     : std::string("Ellipsoid");
  return fmt::format(R"(COMPD_CS["{} + {}",{},VERT_CS["{}",VERT_DATUM["{}",{}],{},AXIS["Up",UP]]])",
                     plane_name(),
                     local    ? "height above the origin"
                     : geoid_ ? "height above the geoid " + geoid_->name()
                              : std::string("ellipsoidal height"),
                     plane_wkt(), heights, datum,
                     local    ? 2000
                     : geoid_ ? 2005
                              : 2002,
                     kMetre);
}

}  // namespace adit
