// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/map_use.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/core.h>

#include "adit/slam/core/units.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/run/run_options.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

void require_sound(const MapUseOptions& options) {
  if (!options.map &&
      (options.localize || options.extend || options.keep || !options.pose.empty())) {
    throw UsageError(std::string(options.localize ? "--localize"
                                 : options.extend ? "--extend"
                                 : options.keep   ? "--keep"
                                                  : "--pose") +
                     ": name the map to use with --map MAP.");
  }
  if (options.localize && options.extend) {
    throw UsageError("--localize and --extend exclude each other.");
  }
  if (options.keep && !options.extend) {
    throw UsageError("--keep needs --extend: a map that a run is localised in stays as it is.");
  }
}

}  // namespace

StartPlace start_place(std::string_view option, std::span<const double> numbers) {
  constexpr double kFarthest = 1e6;  // m
  constexpr double kMostTurns = 36000.0;
  constexpr std::array kNames = {"X", "Y", "Z", "YAW"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const double most = i < 3 ? kFarthest : kMostTurns;
    if (!(std::abs(numbers[i]) <= most)) {
      throw UsageError(fmt::format("{}: {} is {}, and takes a number from {} to {} ({}).", option,
                                   kNames[i], numbers[i], -most, most, i < 3 ? "m" : "degrees"));
    }
  }
  return {.position = {numbers[0], numbers[1], numbers[2]},
          .heading = numbers[3] / kDegreesPerRadian};
}

std::optional<MapUse> map_use(const RunCommandOptions& options, const Config& config) {
  const MapUseOptions& asked = options.earlier_map;
  require_sound(asked);
  if (!asked.map) {
    return std::nullopt;
  }
  if (options.continues) {
    throw UsageError(
        "--continue and --map exclude each other; run the recording again with --map.");
  }
  if (!config.mapping.enabled || !config.mapping.loops) {
    throw UsageError("--map: places of the map are found as loops are; leave out " +
                     std::string(config.mapping.enabled ? "mapping.loops=false"
                                                        : "--odometry and mapping.enabled=false") +
                     ".");
  }
  MapUse use{
      .map = find_map(*asked.map), .extends = asked.extend, .keeps = asked.keep || !asked.extend};
  if (!asked.pose.empty()) {
    use.start = start_place("--pose", asked.pose);
  }
  if (same_file(use.map, RunFiles(options.output).database)) {
    throw UsageError("-o " + options.output.string() + ": the new map would replace " +
                     use.map.string() + ". Name another folder; the map stays as it is.");
  }
  const MapDatabase map(use.map, MapAccess::read);
  if (map.keyframes().empty()) {
    throw InputError(use.map, {}, "it holds no keyframe: there is nothing to recognise",
                     "Map the place first: adit run RECORDING -o OUT");
  }
  return use;
}

void require_new_recording(const MapUse& use, const MapSession& session) {
  for (const MapSession& earlier : MapDatabase(use.map, MapAccess::read).sessions()) {
    if (has_same_recording(earlier, session)) {
      throw InputError(use.map, {},
                       "it holds this recording already, as session " + std::to_string(earlier.id),
                       "Extend a map with another recording");
    }
  }
}

}  // namespace adit
