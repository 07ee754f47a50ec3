// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_merge/tied_maps.hpp"

#include <algorithm>
#include <utility>

#include "adit/tools/setup/config_file.hpp"

namespace adit {
namespace {

/// Of the map with the coarsest submaps: the others' are dense enough for it.
Config config_of(const std::vector<MergeInput>& inputs) {
  const MergeInput& coarsest = *std::ranges::max_element(inputs, {}, &MergeInput::r_submap);
  Config config = parse_config(coarsest.sessions.front().configuration, coarsest.file);
  if (config.preprocess.r_input == 0.0) {
    config.preprocess.r_input = coarsest.r_submap;
  }
  return with_lengths(config, config.preprocess.r_input);
}

std::vector<WorldPart> world_parts(const std::vector<MergeInput>& inputs, const MergedMap& merged) {
  std::vector<WorldPart> parts;
  for (const MergedPart& part : merged.parts) {
    const MergeInput& input = inputs[part.map];
    WorldPart world{.first = part.first,
                    .T_part_first = input.keyframes.front().T_map_keyframe,
                    .fixes = input.map->fixes(),
                    .headings = input.map->headings(),
                    .control = input.map->control_points(),
                    .georeference = input.map->georeference()};
    std::ranges::sort(world.fixes, {}, &MapFix::id);
    for (MapFix& fix : world.fixes) {
      fix.keyframe = part.merged(fix.keyframe);
    }
    for (MapHeading& heading : world.headings) {
      heading.keyframe = part.merged(heading.keyframe);
    }
    for (ControlPoint& point : world.control) {
      point.keyframe = part.merged(point.keyframe);
    }
    parts.push_back(std::move(world));
  }
  return parts;
}

std::vector<const MapStore*> stores_of(const std::vector<MergeInput>& inputs) {
  std::vector<const MapStore*> stores;
  for (const MergeInput& input : inputs) {
    stores.push_back(input.map.get());
  }
  return stores;
}

std::optional<MergedWorld> placed(const TiedMaps& tied, const Config& config) {
  return tied.merged.parts.size() > 1
             ? std::optional(place_in_world(tied.merged.graph,
                                            world_parts(tied.inputs, tied.merged), config.gnss))
             : std::nullopt;
}

}  // namespace

TiedMaps tie_maps(std::vector<MergeInput> inputs, const DeviceOptions& device,
                  const MergeSettings& settings,
                  const std::function<bool(const MergeStep&)>& on_step) {
  TiedMaps tied{.inputs = std::move(inputs)};
  const Config config = config_of(tied.inputs);
  DeviceSession session(device);
  tied.merged =
      merge_maps(session.context(), config, stores_of(tied.inputs), {}, settings, on_step);
  session.require_no_complaints();
  tied.world = placed(tied, config);
  return tied;
}

TiedMaps join_tied_maps(std::vector<MergeInput> inputs, std::span<const MapTie> ties) {
  TiedMaps tied{.inputs = std::move(inputs)};
  JoinedMaps joined = join_maps(stores_of(tied.inputs), ties);
  tied.merged = std::move(joined.merged);
  tied.contradicted = std::move(joined.contradicted);
  tied.world = placed(tied, config_of(tied.inputs));
  return tied;
}

}  // namespace adit
