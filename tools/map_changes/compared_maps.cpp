// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_changes/compared_maps.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_database/writer_lock.hpp"
#include "adit/tools/map_merge/merge_job.hpp"
#include "adit/tools/map_products/map_tiles.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Sessions that have keyframes, without their periods.
std::vector<ComparedSession> sessions_of(const MapDatabase& map,
                                         const std::vector<MapKeyframe>& keyframes) {
  std::vector<ComparedSession> sessions;
  for (const MapSession& session : map.sessions()) {
    ComparedSession compared{.id = session.id, .name = session.name, .map = map.file()};
    for (const MapKeyframe& keyframe : keyframes) {
      if (keyframe.session == session.id) {
        compared.first =
            compared.keyframes == 0 ? keyframe.stamp : std::min(compared.first, keyframe.stamp);
        compared.last = std::max(compared.last, keyframe.stamp);
        ++compared.keyframes;
      }
    }
    if (compared.keyframes > 0) {
      sessions.push_back(std::move(compared));
    }
  }
  std::ranges::sort(sessions, {},
                    [](const ComparedSession& one) { return std::tuple(one.first, one.id); });
  return sessions;
}

/// Damaged poses turn boxes to anything, also to what is no number.
bool is_possible_sight(const Eigen::AlignedBox3d& box) {
  constexpr double kMostFar = 1e8;   // m
  constexpr double kMostWide = 2e4;  // m
  return (box.min().array().abs() < kMostFar).all() && (box.sizes().array() < kMostWide).all();
}

/// Where a keyframe is in the common frame, and which part it belongs to.
struct CommonPlace {
  Eigen::Isometry3d T_common_keyframe = Eigen::Isometry3d::Identity();
  std::size_t part = 0;
};

/// The keyframes of a map, with their places in order.
void add_keyframes(ComparedMaps& compared, std::size_t map,
                   const std::vector<MapKeyframe>& keyframes,
                   const std::vector<CommonPlace>& places) {
  std::map<SessionId, uint32_t> periods;
  for (const ComparedSession& session : compared.sessions) {
    if (session.map == compared.maps[map]->file()) {
      periods[session.id] = session.period;
    }
  }
  const std::map<NodeId, Eigen::AlignedBox3d> seen = boxes_of_sight(*compared.maps[map]);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const MapKeyframe& keyframe = keyframes[i];
    const Eigen::AlignedBox3d& box = seen.at(keyframe.id);
    const Eigen::Isometry3d T_common_map =
        places[i].T_common_keyframe * keyframe.T_map_keyframe.inverse();
    const Eigen::AlignedBox3d there = box.transformed(T_common_map);
    const auto period = periods.find(keyframe.session);
    if (period == periods.end() || !is_possible_sight(there)) {
      throw InputError(compared.maps[map]->file(), {},
                       "keyframe " + std::to_string(keyframe.id) +
                           " has no session, or a pose that is not possible",
                       "`adit check` says what else is wrong");
    }
    compared.keyframes.push_back({.map = map,
                                  .id = keyframe.id,
                                  .period = period->second,
                                  .part = places[i].part,
                                  .T_common_keyframe = places[i].T_common_keyframe,
                                  .seen = there});
  }
}

double largest_cells(const MapDatabase& map, const std::vector<MapKeyframe>& keyframes) {
  double largest = 0.0;
  std::map<SessionId, bool> known;
  for (const MapKeyframe& keyframe : keyframes) {  // a session has one setting
    if (!std::exchange(known[keyframe.session], true)) {
      largest = std::max(largest, load_submap(map, keyframe.id, map.file()).r_submap);
    }
  }
  return largest;
}

/// Throws InputError where no part has keyframes of two sessions.
void require_tied_sessions(const ComparedMaps& compared) {
  std::map<std::size_t, uint32_t> first_of_part;
  for (const ComparedKeyframe& keyframe : compared.keyframes) {
    const auto [part, is_new] = first_of_part.try_emplace(keyframe.part, keyframe.period);
    if (part->second != keyframe.period) {
      return;
    }
  }
  throw InputError(compared.maps.front()->file(), {},
                   "its sessions are not tied to each other: how they lie to each other is a guess",
                   "`adit merge` of maps of its sessions ties them if they have places in common");
}

ComparedMaps of_one_map(const fs::path& given) {
  ComparedMaps compared;
  compared.maps.push_back(std::make_unique<MapDatabase>(find_map(given), MapAccess::read));
  const MapDatabase& map = *compared.maps.front();
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  compared.sessions = sessions_of(map, keyframes);
  if (compared.sessions.size() < 2) {
    throw InputError(map.file(), {},
                     compared.sessions.empty()
                         ? "it holds no keyframe: there is nothing to compare"
                         : "it holds one session: there is nothing to compare it with",
                     "Name a second map, or merge the maps of several sessions with `adit merge`");
  }
  for (uint32_t period = 0; ComparedSession & session : compared.sessions) {
    session.period = period++;
  }
  const PoseGraph graph = map.graph();
  const std::vector<std::size_t> parts = connected_components(graph).component_of;
  std::vector<CommonPlace> places;
  for (const MapKeyframe& keyframe : keyframes) {
    places.push_back(
        {.T_common_keyframe = keyframe.T_map_keyframe, .part = parts[graph.index_of(keyframe.id)]});
  }
  add_keyframes(compared, 0, keyframes, places);
  require_tied_sessions(compared);
  compared.r_submap = largest_cells(map, keyframes);
  compared.georeference = map.georeference();
  return compared;
}

ComparedMaps of_two_maps(const std::vector<fs::path>& maps, const DeviceOptions& device,
                         const std::function<bool(const MergeStep&)>& on_step) {
  const fs::path first = find_map(maps.front());
  // Whoever asks what has changed says that both are of one site.
  TiedMaps tied = tie_maps(open_merge_inputs(maps), device, {.same_site = true}, on_step);
  if (!tied.world) {
    const MapApart apart = maps_apart(tied.inputs, tied.merged).front();
    throw InputError(find_map(maps.back()), {},
                     "it cannot be tied to " + first.string() + ": " + apart.reason,
                     "Compare maps of places that overlap");
  }
  const std::vector<std::size_t> parts = connected_components(tied.world->graph).component_of;
  const bool is_in_order = tied.inputs.front().file == first;
  ComparedMaps compared;
  for (uint32_t period = 0; period < 2; ++period) {
    const std::size_t number = is_in_order ? period : 1 - period;
    MergeInput& input = tied.inputs[number];
    const auto part = std::ranges::find(tied.merged.parts, number, &MergedPart::map);
    std::vector<CommonPlace> places;
    const PoseGraph& graph = tied.world->graph;
    for (const MapKeyframe& keyframe : input.keyframes) {
      const std::size_t node = graph.index_of(part->merged(keyframe.id));
      places.push_back({.T_common_keyframe = graph.nodes()[node].T_map_node, .part = parts[node]});
      if (period == 0) {
        compared.ties.push_back({.T_common_keyframe = places.back().T_common_keyframe,
                                 .T_map_keyframe = keyframe.T_map_keyframe});
      }
    }
    for (ComparedSession& session : sessions_of(*input.map, input.keyframes)) {
      session.period = period;
      compared.sessions.push_back(std::move(session));
    }
    compared.r_submap = std::max(compared.r_submap, largest_cells(*input.map, input.keyframes));
    compared.maps.push_back(std::move(input.map));
    add_keyframes(compared, period, input.keyframes, places);
  }
  compared.georeference = compared.maps.front()->georeference();
  return compared;
}

}  // namespace

Eigen::Isometry3d ComparedMaps::T_map_common(const Eigen::Vector3d& place) const {
  if (ties.empty()) {
    return Eigen::Isometry3d::Identity();
  }
  const auto nearest = std::ranges::min_element(ties, {}, [&](const FrameTie& tie) {
    return (tie.T_common_keyframe.translation() - place).squaredNorm();
  });
  return nearest->T_map_keyframe * nearest->T_common_keyframe.inverse();
}

ComparedMaps compared_maps(const std::vector<fs::path>& maps, const DeviceOptions& device,
                           const std::function<bool(const MergeStep&)>& on_step) {
  if (maps.size() != 1 && maps.size() != 2) {
    throw UsageError("name a map of several sessions, or two maps: adit changes BEFORE AFTER");
  }
  ComparedMaps compared =
      maps.size() == 1 ? of_one_map(maps.front()) : of_two_maps(maps, device, on_step);
  std::ranges::stable_sort(compared.keyframes, {}, &ComparedKeyframe::period);
  return compared;
}

}  // namespace adit
