// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_world.hpp"

#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {
namespace {

// Farther away than any map reaches, and as far as the projections are exact.
constexpr double kFarthestOnEarth = 1e6;  // m

/// Nothing where UTM does not have the map.
std::optional<ProductCoordinates> utm_coordinates(const Georeference& earth) {
  try {
    return ProductCoordinates(earth, ProductFrame::utm);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

nlohmann::ordered_json on_earth(const Georeference& earth, const Eigen::Vector3d& p_map) {
  const Eigen::Vector3d p_world = earth.T_world_map * p_map;
  if (!p_world.allFinite() || p_world.cwiseAbs().maxCoeff() > kFarthestOnEarth) {
    return nullptr;
  }
  const Geodetic place = WorldFrame(earth.origin).place_of(p_world);
  nlohmann::ordered_json json = {{"latitude", place.latitude},
                                 {"longitude", place.longitude},
                                 {"altitude", place.altitude},
                                 {"utm", nullptr}};
  try {
    const UtmZone zone = zone_of(earth);
    const UtmPosition utm = utm_of(place, zone);
    json["utm"] = {{"zone", to_string(zone)}, {"easting", utm.easting}, {"northing", utm.northing}};
  } catch (const std::invalid_argument&) {
    // Too far from the zone: the geodetic coordinates are enough.
  }
  return json;
}

}  // namespace

nlohmann::ordered_json world_of(const std::optional<Georeference>& earth) {
  if (!earth) {
    return nullptr;
  }
  const WorldFrame world(earth->origin);
  const double convergence = world.convergence_at(earth->T_world_map.translation());
  // The frame's y axis lies `convergence` clockwise of true north.
  const Eigen::Vector3d north = earth->T_world_map.linear().transpose() *
                                Eigen::Vector3d(-std::sin(convergence), std::cos(convergence), 0.0);
  const std::optional<ProductCoordinates> utm = utm_coordinates(*earth);
  return {{"north", {north.x(), north.y(), north.z()}},
          {"coordinates", utm ? utm->name() : std::string("WGS 84")}};
}

std::string place_answer(const std::optional<Georeference>& earth, const Eigen::Vector3d& p_map) {
  return nlohmann::ordered_json(
             {{"type", "place"},
              {"p", {p_map.x(), p_map.y(), p_map.z()}},
              {"world", earth ? on_earth(*earth, p_map) : nlohmann::ordered_json()}})
      .dump();
}

}  // namespace adit
