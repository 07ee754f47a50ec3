// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What other viewers are shown of a run or a map, but for its points: those are read piece by piece
// when they are written.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "adit/slam/gnss/map_fix.hpp"
#include "adit/slam/gnss/world_frame.hpp"
#include "adit/tools/foxglove/foxglove_graph.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/results/sweep_table.hpp"

namespace adit {

struct ShownRun {
  std::filesystem::path map;        ///< map.adit; empty: there is none, and `cloud` is shown
  std::filesystem::path cloud;      ///< map.ply; empty: there is none
  std::filesystem::path recording;  ///< that was mapped, by summary.json; empty: not known
  std::vector<StampedPose> poses;   ///< T_map_lidar of the sweeps, in the order of keyframes
  std::vector<std::size_t> parts;   ///< poses that nothing ties to those before them
  std::vector<MapKeyframe> keyframes;
  std::vector<SweepRecord> sweeps;  ///< of sweeps.csv; empty: there is none
  std::vector<ShownEvent> events;   ///< the verdict, where it is in doubt, and loops
  std::vector<MapFix> fixes;        ///< all that are somewhere
  std::optional<Georeference> georeference{};
};

/// `what` is the folder of a run, or a map. Throws InputError: it is neither, or damaged.
ShownRun read_shown_run(const std::filesystem::path& what);

}  // namespace adit
