// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Changes of a map's loops by hand: a loop is taken back or let in again, and the map is optimised
// anew.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/mapping/map_store.hpp"

namespace adit {

/// What a change by hand has done to the map.
struct LoopChange {
  int64_t id = 0;
  std::string what;  ///< revoked, restored, added
  double cost_before = 0.0;
  double cost_after = 0.0;
  double moved = 0.0;  ///< m, that keyframe which moved most
};

enum class LoopAction {
  revoke,   ///< take an accepted loop back
  restore,  ///< let it in again
};

/// Changes the map as a whole or not at all; nothing is lost, each action undoes the other. Throws
/// UsageError: no such loop, or not one that can be; InputError: no map, or its graph cannot be
/// optimised; LockedError: another program writes to it; OutputError.
LoopChange change_loop(const std::filesystem::path& map, int64_t id, LoopAction action);

/// The graph where an optimisation with its loops has it: what moves from here, a change moves.
/// Throws InputError where that fails.
PoseGraph settled(PoseGraph graph, const std::filesystem::path& map);

/// The graph optimised with its loops. `map` is for messages. Throws InputError where that fails.
OptimizedGraph optimized_map(const PoseGraph& graph, const std::filesystem::path& map);

/// The candidates; accepted ones say how well they fit after the optimisation. Throws InputError
/// where one has no edge.
std::vector<LoopCandidate> with_residuals(std::vector<LoopCandidate> candidates,
                                          const PoseGraph& graph, const OptimizationReport& report,
                                          const std::filesystem::path& map);

/// How far an optimisation moves the keyframe that it moves most, m.
double farthest_moved(const PoseGraph& graph, const std::vector<Eigen::Isometry3d>& poses);

}  // namespace adit
