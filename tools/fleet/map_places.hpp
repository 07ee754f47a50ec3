// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which maps of a fleet may have places in common.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/gnss/world_frame.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// Where a map's keyframes lie on the Earth.
struct MapPlaces {
  std::size_t keyframes = 0;
  /// Of its keyframes; of a map without a place in the world of those that have a fix. Empty: it is
  /// not known, or too roughly.
  std::vector<Geodetic> places{};
  double gap = 0.0;  ///< m, the longest part of its way that none of them is on
};

/// Of a map. Fixes that are too few to place a map say all the same where to look for it.
MapPlaces places_of(const MapDatabase& map);

/// JSON, and back. Throws InputError where the file holds something else.
std::string to_json(const MapPlaces& places);
MapPlaces read_places(const std::filesystem::path& file);

/// Two maps by their numbers, the smaller one first.
using MapPair = std::pair<std::size_t, std::size_t>;

/// Pairs whose places lie near each other, as far as their gaps allow to tell, or of which one has
/// none; in order.
std::vector<MapPair> pairs_to_search(std::span<const MapPlaces> maps);

}  // namespace adit
