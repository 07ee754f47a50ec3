// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether a map's edges err as much as they say (docs/theory/mapping.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// Edges between consecutive keyframes beside the true motion. NEES: squared error by the edge's
/// information, a degree of freedom; 1 where it is right.
struct EdgeConsistency {
  std::size_t edges = 0;  ///< both of whose keyframes the truth covers
  double nees = 0.0;      ///< mean
  double median = 0.0;
  double translation = 0.0;      ///< mean, of it alone
  double rotation = 0.0;         ///< mean, of it alone
  double rms_translation = 0.0;  ///< m
  double rms_rotation = 0.0;     ///< rad
};

/// Nothing where no edge is covered. `map` is the file; throws InputError.
std::optional<EdgeConsistency> edge_consistency(const std::filesystem::path& map,
                                                const Trajectory& truth);

/// One line for people, and for programs.
std::string describe(const EdgeConsistency& found);
nlohmann::ordered_json to_json(const EdgeConsistency& found);

}  // namespace adit
