// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a page is told of a map's place on the Earth, as JSON. The geodesy is done here, so that the
// page has the coordinates that exports have.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/gnss/world_frame.hpp"

namespace adit {

/// "world" of a graph: true north at the map's origin, a unit vector in the map's axes, and what
/// the coordinates on the Earth are called. Null where the map has no place there.
nlohmann::ordered_json world_of(const std::optional<Georeference>& earth);

/// The answer to {"place": [x, y, z]}, a place of the map's frame (m): that place and, where it is
/// known, latitude and longitude (degrees), altitude above the ellipsoid, easting and northing in
/// the map's zone of UTM (m).
std::string place_answer(const std::optional<Georeference>& earth, const Eigen::Vector3d& p_map);

}  // namespace adit
