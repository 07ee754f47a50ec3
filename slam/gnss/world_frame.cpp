// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/world_frame.hpp"

#include <cmath>
#include <stdexcept>

#include <GeographicLib/Constants.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <GeographicLib/UTMUPS.hpp>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

using GeographicLib::TransverseMercator;
using GeographicLib::UTMUPS;

const Geodetic& checked(const Geodetic& place) {
  const bool possible = std::isfinite(place.altitude) && std::isfinite(place.longitude) &&
                        std::abs(place.latitude) <= kMostLatitude;
  if (!possible) {
    throw std::invalid_argument(
        "a world frame needs a latitude within 84 degrees, a longitude and "
        "an altitude that are finite");
  }
  return place;
}

/// The mean radius of curvature there, m.
double radius_at(double latitude) {
  const double e2 =
      GeographicLib::Constants::WGS84_f() * (2.0 - GeographicLib::Constants::WGS84_f());
  const double s = std::sin(latitude * kDegree);
  const double w2 = 1.0 - e2 * s * s;
  return GeographicLib::Constants::WGS84_a() * std::sqrt(1.0 - e2) / w2;
}

TransverseMercator projection(double scale) {
  return {GeographicLib::Constants::WGS84_a(), GeographicLib::Constants::WGS84_f(), scale};
}

}  // namespace

WorldFrame::WorldFrame(const Geodetic& origin)
    : origin_(checked(origin)),
      scale_(1.0 + origin.altitude / radius_at(origin.latitude)),
      northing_of_origin_(0.0) {
  double x = 0.0;
  projection(scale_).Forward(origin.longitude, origin.latitude, origin.longitude, x,
                             northing_of_origin_);
}

Eigen::Vector3d WorldFrame::position_of(const Geodetic& place) const {
  double x = 0.0;
  double y = 0.0;
  projection(scale_).Forward(origin_.longitude, place.latitude, place.longitude, x, y);
  return {x, y - northing_of_origin_, place.altitude - origin_.altitude};
}

Geodetic WorldFrame::place_of(const Eigen::Vector3d& position) const {
  Geodetic place{.altitude = position.z() + origin_.altitude};
  projection(scale_).Reverse(origin_.longitude, position.x(), position.y() + northing_of_origin_,
                             place.latitude, place.longitude);
  return place;
}

double WorldFrame::convergence_at(const Eigen::Vector3d& position) const {
  double latitude = 0.0;
  double longitude = 0.0;
  double degrees = 0.0;
  double scale = 1.0;
  projection(scale_).Reverse(origin_.longitude, position.x(), position.y() + northing_of_origin_,
                             latitude, longitude, degrees, scale);
  return degrees * kDegree;
}

Geodetic place_in_tangent_plane(const Geodetic& origin, const Eigen::Vector3d& east_north_up) {
  const GeographicLib::LocalCartesian plane(origin.latitude, origin.longitude, origin.altitude);
  Geodetic place;
  plane.Reverse(east_north_up.x(), east_north_up.y(), east_north_up.z(), place.latitude,
                place.longitude, place.altitude);
  return place;
}

UtmPosition utm_of(const Geodetic& place, std::optional<UtmZone> in) {
  UtmPosition utm;
  double degrees = 0.0;
  try {
    UTMUPS::Forward(place.latitude, place.longitude, utm.zone, utm.north, utm.easting, utm.northing,
                    degrees, utm.scale, in ? in->zone : int{UTMUPS::UTM});
    if (in && in->north != utm.north) {
      int zone = 0;
      UTMUPS::Transfer(utm.zone, utm.north, utm.easting, utm.northing, in->zone, in->north,
                       utm.easting, utm.northing, zone);
      utm.north = in->north;
    }
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument(error.what());
  }
  utm.convergence = degrees * kDegree;
  return utm;
}

Geodetic place_of(const UtmPosition& position, double altitude) {
  Geodetic place{.altitude = altitude};
  try {
    UTMUPS::Reverse(position.zone, position.north, position.easting, position.northing,
                    place.latitude, place.longitude);
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument(error.what());
  }
  return place;
}

std::optional<Georeference> placed(std::optional<Georeference> georeference,
                                   const Eigen::Isometry3d& T_world_map) {
  if (georeference) {
    georeference->T_world_map = T_world_map;
  }
  return georeference;
}

}  // namespace adit
