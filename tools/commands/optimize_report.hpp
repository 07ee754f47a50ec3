// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit optimize` says of what it has done.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/commands/command_optimize.hpp"
#include "adit/tools/map_edits/control_points.hpp"
#include "adit/tools/map_products/g2o_file.hpp"

namespace adit {

/// What `adit optimize` has done, for the report.
struct OptimizeOutcome {
  G2oFile file;
  bool is_map = false;     ///< its graph and the numbers of its edges stand in `file`
  double file_cost = 0.0;  ///< where the file has the nodes
  InitialPoses initial = InitialPoses::file;  ///< what it started from
  OptimizedGraph optimized;
  std::optional<double> odometry_scale{};      ///< of a map's own model (LoopOptimum)
  double level_drift_scale = 1.0;              ///< the same
  bool all_drift = false;                      ///< the same
  std::optional<ControlAdjustment> control{};  ///< asked for
  bool moved = false;  ///< a node, or the map in the world, is not where the file has it
  std::vector<std::size_t> worst;  ///< edges with the largest chi squared, that one first
};

/// For a map it is the convention that its information belongs to.
ResidualConvention convention_of(const OptimizeCommandOptions& options,
                                 const OptimizeOutcome& outcome);

/// For people, line by line.
std::string describe(const OptimizeCommandOptions& options, const OptimizeOutcome& outcome);
/// As docs/schemas/optimize.schema.json has it.
std::string to_json(const OptimizeCommandOptions& options, const OptimizeOutcome& outcome);

}  // namespace adit
