// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps that are read, and one graph of them.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "adit/slam/mapping/map_merge.hpp"
#include "adit/slam/mapping/map_ties.hpp"
#include "adit/slam/mapping/merged_world.hpp"
#include "adit/tools/map_merge/merge_inputs.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

struct TiedMaps {
  std::vector<MergeInput> inputs{};         ///< as open_merge_inputs() sorts them
  MergedMap merged{};                       ///< parts count the inputs
  std::optional<MergedWorld> world{};       ///< optimised; none: no map is tied to another
  std::vector<std::size_t> contradicted{};  ///< JoinedMaps::contradicted
};

/// Ties the maps that open_merge_inputs() has opened to each other; nothing is written. `on_step`
/// as of merge_maps(). Throws InputError, MergeStopped and what the device throws.
TiedMaps tie_maps(std::vector<MergeInput> inputs, const DeviceOptions& device,
                  const MergeSettings& settings,
                  const std::function<bool(const MergeStep&)>& on_step);

/// The same of maps whose pairs were searched before. Ties count the inputs.
TiedMaps join_tied_maps(std::vector<MergeInput> inputs, std::span<const MapTie> ties);

}  // namespace adit
