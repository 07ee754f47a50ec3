// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/map_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "adit/slam/loops/loop_voting.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

// m. Two keyframes that see the same are about so near to each other: a lidar's usual range in a
// street. A map that is known no better than that is compared with all others.
constexpr double kReach = 30.0;

bool is_near(const Eigen::Matrix2d& covariance) {
  return covariance.trace() < kReach * kReach;
}

using Cell = std::pair<int64_t, int64_t>;

Cell cell_of(const Eigen::Vector3d& position) {
  return {static_cast<int64_t>(std::floor(position.x() / kReach)),
          static_cast<int64_t>(std::floor(position.y() / kReach))};
}

/// Keyframes of a map by cell.
using Cells = std::map<Cell, std::size_t>;

std::vector<Cells> cells_of(std::span<const MapPlaces> maps) {
  std::optional<WorldFrame> frame;
  std::vector<Cells> all;
  for (const MapPlaces& map : maps) {
    Cells& cells = all.emplace_back();
    for (const Geodetic& place : map.places) {
      if (!frame) {
        frame.emplace(place);
      }
      ++cells[cell_of(frame->position_of(place))];
    }
  }
  return all;
}

/// Keyframes that lie in cells of the other map or beside them.
std::size_t near_ones(const Cells& one, const Cells& other) {
  std::size_t near = 0;
  for (const auto& [cell, keyframes] : one) {
    bool found = false;
    for (int64_t i = -1; i <= 1; ++i) {
      for (int64_t k = -1; k <= 1; ++k) {
        found = found || other.contains({cell.first + i, cell.second + k});
      }
    }
    near += found ? keyframes : 0;
  }
  return near;
}

/// The longest way without a fix, from one to the next and before the first and behind the last.
double longest_gap(const std::map<NodeId, Geodetic>& fixes,
                   const std::vector<MapKeyframe>& keyframes) {
  double longest = 0.0;
  double since = 0.0;
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    since = fixes.contains(keyframes[i - 1].id) ? 0.0 : since;
    since +=
        (keyframes[i].T_map_keyframe.translation() - keyframes[i - 1].T_map_keyframe.translation())
            .norm();
    longest = std::max(longest, since);
  }
  return longest;
}

/// Whether a place of one map lies so near to one of the other (m).
bool any_within(const MapPlaces& one, const MapPlaces& other, double distance) {
  const WorldFrame frame(one.places.front());
  std::vector<Eigen::Vector2d> of_other;
  for (const Geodetic& place : other.places) {
    of_other.emplace_back(frame.position_of(place).head<2>());
  }
  return std::ranges::any_of(one.places, [&](const Geodetic& place) {
    const Eigen::Vector2d at = frame.position_of(place).head<2>();
    return std::ranges::any_of(
        of_other, [&](const Eigen::Vector2d& there) { return (there - at).norm() <= distance; });
  });
}

}  // namespace

MapPlaces places_of(const MapDatabase& map) {
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  MapPlaces places{.keyframes = keyframes.size()};
  const std::optional<Georeference> georeference = map.georeference();
  if (georeference && is_near(georeference->covariance.topLeftCorner<2, 2>())) {
    const WorldFrame frame(georeference->origin);
    for (const MapKeyframe& keyframe : keyframes) {
      places.places.push_back(
          frame.place_of(georeference->T_world_map * keyframe.T_map_keyframe.translation()));
    }
    return places;
  }
  std::map<NodeId, Geodetic> fixes;
  for (const MapFix& fix : map.fixes()) {
    if (is_near(fix.covariance.topLeftCorner<2, 2>())) {
      fixes.emplace(fix.keyframe, fix.place);
    }
  }
  for (const auto& [keyframe, place] : fixes) {
    places.places.push_back(place);
  }
  places.gap = longest_gap(fixes, keyframes);
  return places;
}

std::string to_json(const MapPlaces& places) {
  Json json;
  json["keyframes"] = places.keyframes;
  json["gap"] = places.gap;
  json["places"] = Json::array();
  for (const Geodetic& place : places.places) {
    json["places"].push_back({place.latitude, place.longitude, place.altitude});
  }
  return json.dump() + "\n";
}

MapPlaces read_places(const std::filesystem::path& file) {
  try {
    const Json json = Json::parse(read_text_file(file));
    MapPlaces places{.keyframes = json.at("keyframes").get<std::size_t>(),
                     .gap = json.at("gap").get<double>()};
    for (const Json& place : json.at("places")) {
      const auto numbers = place.get<std::array<double, 3>>();
      places.places.push_back(
          {.latitude = numbers[0], .longitude = numbers[1], .altitude = numbers[2]});
    }
    return places;
  } catch (const Json::exception& error) {
    throw InputError(file, {}, std::string("it does not say where a map lies: ") + error.what(),
                     "Remove the folder it is in, and run the shard of that map again");
  }
}

std::vector<MapPair> pairs_to_search(std::span<const MapPlaces> maps) {
  const std::vector<Cells> cells = cells_of(maps);
  const std::size_t least = LoopVotingSettings{}.least_unexpected;  // that a tie needs
  std::vector<MapPair> pairs;
  for (std::size_t one = 0; one < maps.size(); ++one) {
    for (std::size_t other = one + 1; other < maps.size(); ++other) {
      const double gaps = maps[one].gap + maps[other].gap;
      if (cells[one].empty() || cells[other].empty() ||
          std::max(near_ones(cells[one], cells[other]), near_ones(cells[other], cells[one])) >=
              least ||
          (gaps > kReach && any_within(maps[one], maps[other], kReach + gaps))) {
        pairs.emplace_back(one, other);
      }
    }
  }
  return pairs;
}

}  // namespace adit
