// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/volume_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/export/export_job.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

ExportJob job_of(const VolumeCommandOptions& options, const MapDatabase& map) {
  ExportJob job{.map = &map, .options = &options.place, .file = {}};
  job.georeference =
      options.place.origin ? parse_origin(*options.place.origin) : map.georeference();
  return job;
}

/// The session of a keyframe of these.
std::vector<ComparedSession> sessions_in(const std::vector<ComparedSession>& all,
                                         const std::vector<int64_t>& ids, const char* option) {
  std::vector<ComparedSession> chosen;
  for (const int64_t id : ids) {
    const auto found = std::ranges::find(all, id, &ComparedSession::id);
    if (found == all.end()) {
      throw UsageError(
          fmt::format("{} {}: the map has no such session with keyframes. `adit info` lists them.",
                      option, id));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

/// The states of `compared`: two maps, or two sets of sessions of one.
void choose_states(const VolumeCommandOptions& options, const ComparedMaps& compared,
                   VolumeInput& input) {
  VolumeOutcome& outcome = input.outcome;
  if (options.maps.size() == 2) {
    outcome.base = VolumeBase::tied;
    for (const ComparedSession& session : compared.sessions) {
      (session.period == 0 ? outcome.before : outcome.after).push_back(session);
    }
    return;
  }
  outcome.base = VolumeBase::sessions;
  outcome.before = options.before.empty()
                       ? std::vector{compared.sessions.front()}
                       : sessions_in(compared.sessions, options.before, "--before");
  outcome.after = options.after.empty() ? std::vector{compared.sessions.back()}
                                        : sessions_in(compared.sessions, options.after, "--after");
  for (const ComparedSession& session : outcome.after) {
    if (std::ranges::find(outcome.before, session.id, &ComparedSession::id) !=
        outcome.before.end()) {
      throw UsageError(
          fmt::format("session {} is both before and after: there is nothing to compare. Choose "
                      "others with --before and --after.",
                      session.id));
    }
  }
}

void add_compared(const VolumeCommandOptions& options, ComparedMaps compared, VolumeInput& input) {
  choose_states(options, compared, input);
  const auto has = [](const std::vector<ComparedSession>& sessions, uint32_t period) {
    return std::ranges::find(sessions, period, &ComparedSession::period) != sessions.end();
  };
  std::vector<std::map<NodeId, MapKeyframe>> keyframes;
  for (const auto& map : compared.maps) {
    for (const MapKeyframe& keyframe : map->keyframes()) {
      keyframes.resize(compared.maps.size());
      keyframes[static_cast<std::size_t>(&map - compared.maps.data())].emplace(keyframe.id,
                                                                               keyframe);
    }
  }
  std::set<std::size_t> parts[2];
  for (const ComparedKeyframe& one : compared.keyframes) {
    MapKeyframe keyframe = keyframes[one.map].at(one.id);
    keyframe.T_map_keyframe =
        compared.T_map_common(one.T_common_keyframe.translation()) * one.T_common_keyframe;
    for (const bool is_after : {false, true}) {
      if (has(is_after ? input.outcome.after : input.outcome.before, one.period)) {
        parts[is_after ? 1 : 0].insert(one.part);
        (is_after ? input.after : input.before)
            .push_back({.map = compared.maps[one.map].get(),
                        .coordinates = input.coordinates.front().get(),
                        .keyframe = keyframe});
      }
    }
  }
  if (std::ranges::none_of(parts[0], [&](std::size_t part) { return parts[1].contains(part); })) {
    throw InputError(
        compared.maps.front()->file(), {},
        "the sessions before and after are not tied to each other: how they lie to "
        "each other is a guess",
        "`adit merge` of maps of its sessions ties them if they have places in common");
  }
  input.maps = std::move(compared.maps);
}

/// m2, of the height of a map in the world.
double height_variance(const Georeference& georeference) {
  const Eigen::Matrix3d R = georeference.T_world_map.linear();
  const Eigen::Matrix3d world = R * georeference.covariance.topLeftCorner<3, 3>() * R.transpose();
  return world(2, 2);
}

std::vector<VolumeKeyframe> all_keyframes(const MapDatabase& map,
                                          const ProductCoordinates& coordinates) {
  std::vector<VolumeKeyframe> keyframes;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    keyframes.push_back({.map = &map, .coordinates = &coordinates, .keyframe = keyframe});
  }
  if (keyframes.empty()) {
    throw InputError(map.file(), {}, "it holds no keyframe: there is nothing to measure",
                     "Name a map of a run");
  }
  return keyframes;
}

std::vector<ComparedSession> sessions_of_map(const MapDatabase& map) {
  std::vector<ComparedSession> sessions;
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  for (const MapSession& session : map.sessions()) {
    ComparedSession one{.id = session.id, .name = session.name, .map = map.file()};
    for (const MapKeyframe& keyframe : keyframes) {
      if (keyframe.session == session.id) {
        one.first = one.keyframes == 0 ? keyframe.stamp : std::min(one.first, keyframe.stamp);
        one.last = std::max(one.last, keyframe.stamp);
        ++one.keyframes;
      }
    }
    if (one.keyframes > 0) {
      sessions.push_back(std::move(one));
    }
  }
  return sessions;
}

void add_georeferenced(const VolumeCommandOptions& options, VolumeInput& input) {
  input.outcome.base = VolumeBase::georeferenced;
  double variance = 0.0;
  ExportCommandOptions place = options.place;
  for (std::size_t i = 0; i < 2; ++i) {
    input.maps.push_back(std::make_unique<MapDatabase>(find_map(options.maps[i]), MapAccess::read));
    const MapDatabase& map = *input.maps.back();
    const auto georeference = map.georeference();
    if (!georeference) {
      throw InputError(map.file(), {}, "it has no place on the Earth",
                       "Leave out --as-georeferenced: maps are then tied by what both saw");
    }
    variance += height_variance(*georeference);
    if (i == 0) {
      if (!place.crs && !place.utm) {
        place.utm = to_string(zone_of(*georeference));
      }
    }
    ExportJob job{.map = &map, .options = &place, .file = {}, .georeference = georeference};
    input.coordinates.push_back(std::make_unique<ProductCoordinates>(coordinates_of(job, true)));
    if (i == 0) {
      input.selection = selection_of(job, *input.coordinates.back());
    }
    (i == 0 ? input.before : input.after) = all_keyframes(map, *input.coordinates.back());
    (i == 0 ? input.outcome.before : input.outcome.after) = sessions_of_map(map);
  }
  input.outcome.tie_error = std::sqrt(variance);
}

}  // namespace

VolumeInput volume_input(const VolumeCommandOptions& options,
                         const std::function<bool(const MergeStep&)>& on_step) {
  VolumeInput input;
  if (options.as_georeferenced) {
    add_georeferenced(options, input);
    return input;
  }
  const bool is_plane = !options.above.empty();
  const MapDatabase map(find_map(options.maps.front()), MapAccess::read);
  const ExportJob job = job_of(options, map);
  input.coordinates.push_back(std::make_unique<ProductCoordinates>(coordinates_of(job, true)));
  input.selection = selection_of(job, *input.coordinates.front());
  if (is_plane) {
    input.maps.push_back(
        std::make_unique<MapDatabase>(find_map(options.maps.front()), MapAccess::read));
    input.outcome.base =
        options.above == "surroundings" ? VolumeBase::surroundings : VolumeBase::height;
    input.outcome.after = sessions_of_map(*input.maps.front());
    if (!options.after.empty()) {
      input.outcome.after = sessions_in(input.outcome.after, options.after, "--after");
    }
    for (VolumeKeyframe& keyframe :
         all_keyframes(*input.maps.front(), *input.coordinates.front())) {
      if (std::ranges::find(input.outcome.after, keyframe.keyframe.session, &ComparedSession::id) !=
          input.outcome.after.end()) {
        input.after.push_back(std::move(keyframe));
      }
    }
    return input;
  }
  add_compared(options, compared_maps(options.maps, options.place.device, on_step), input);
  return input;
}

void check_volume(const VolumeCommandOptions& options) {
  const bool is_plane = !options.above.empty();
  if (options.maps.empty() || options.maps.size() > 2) {
    throw UsageError("name a map of several sessions, or two maps: adit volume BEFORE AFTER");
  }
  if (is_plane && options.maps.size() == 2) {
    throw UsageError("--above is of one map; leave it out to compare two.");
  }
  if (is_plane && options.above != "surroundings") {
    const auto height = parse_double(options.above);
    if (!height || !std::isfinite(*height)) {
      throw UsageError("--above " + options.above +
                       ": expected a height in the product's frame (m), or surroundings.");
    }
  }
  if (is_plane && options.place.box.empty() && !options.place.polygon) {
    throw UsageError("--above: say what heap it is, with --polygon or --box.");
  }
  if ((is_plane && !options.before.empty()) ||
      (options.maps.size() == 2 && (!options.before.empty() || !options.after.empty()))) {
    throw UsageError(
        "--before and --after choose sessions of one map; with --above, --after alone.");
  }
  if (options.as_georeferenced && options.maps.size() != 2) {
    throw UsageError("--as-georeferenced needs two maps.");
  }
  if (options.as_georeferenced &&
      (options.place.origin || options.place.frame == "local" || options.place.frame == "map")) {
    throw UsageError("--as-georeferenced: heights are compared in UTM or --crs.");
  }
  if (options.as_measured && is_plane) {
    throw UsageError("--as-measured is for two states; a plane is compared as it is.");
  }
  if (options.place.crs && (options.place.utm || !options.place.frame.empty())) {
    throw UsageError("--crs and " + std::string(options.place.utm ? "--utm" : "--frame") +
                     " exclude each other.");
  }
  if (!options.place.box.empty() && options.place.polygon) {
    throw UsageError("--box and --polygon exclude each other.");
  }
  if (options.raster) {
    const std::string end = options.raster->extension().string();
    if (end != ".tif" && end != ".tiff") {
      throw UsageError("--raster " + options.raster->string() +
                       ": the raster is a GeoTIFF; name it *.tif.");
    }
    for (const fs::path& map : options.maps) {
      keep_input("--raster", *options.raster, map);
    }
    keep_input("--raster", *options.raster, options.place.polygon.value_or(fs::path()));
  }
}

}  // namespace adit
