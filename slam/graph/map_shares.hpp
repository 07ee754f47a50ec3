// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What each kind of measurement contributes to a map's poses (docs/theory/pose_graph.md).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// Where a pose graph's information comes from.
enum class MapSource { odometry, loops, fixes, headings, verticals };
inline constexpr std::size_t kMapSources = 5;

/// Parts of a keyframe's pose relative to the first keyframe: position in the level of the map,
/// height, and the turn about the vertical.
enum class MapPart { level, height, yaw };
inline constexpr std::size_t kMapParts = 3;
/// The enumerator's name.
constexpr std::string_view to_string(MapPart part) {
  constexpr std::array<std::string_view, kMapParts> kNames = {"level", "height", "yaw"};
  return kNames.at(static_cast<std::size_t>(part));
}

/// Shares of the information about keyframes' poses relative to the first of their part of the map,
/// the mean over keyframes: those of a part add up to 1 over all sources.
struct MapShares {
  std::array<std::array<double, kMapParts>, kMapSources> of{};  ///< by source, then by part

  double operator()(MapSource source, MapPart part) const {
    return of[static_cast<std::size_t>(source)][static_cast<std::size_t>(part)];
  }
};

/// Of the graph where it is, by the informations that it has. Sixteen keyframes, evenly chosen,
/// speak for all. None where there is one keyframe, or the information is singular.
std::optional<MapShares> map_shares(const PoseGraph& graph);

}  // namespace adit
