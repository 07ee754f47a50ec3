// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run says of itself over time: the small plots above the time line, and directions that
// sweeps were not held in.
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>

#include <nlohmann/json.hpp>

#include "adit/tools/viewer/view_graph.hpp"

namespace adit {

/// No more are told of a curve, however long the run was: a page is hardly wider.
inline constexpr std::size_t kMostPlotBins = 1024;

/// No more weak directions are told of; evenly thinned.
inline constexpr std::size_t kMostWeak = 4000;

/// Of a scene, as JSON.
struct ViewRun {
  /// Curves with the least and the most of each of so many equal times (null: nothing is known),
  /// and stretches that the run does not vouch for. Null where there is no sweeps.csv.
  nlohmann::ordered_json plots;
  /// Directions of translation that were held in part or not at all (unit, map axes), with the
  /// position of their sweep in "sweeps".
  nlohmann::ordered_json weak;
};

/// What has no `sweeps.csv`.
ViewRun no_run();

/// By `sweeps.csv` and `summary.json` of a run's folder; a table that is damaged is told to
/// `progress`, and nothing else of it. `sweeps` are those of the scene.
ViewRun run_of(const std::filesystem::path& folder, const ViewSpan& span,
               const std::vector<ViewSweep>& sweeps, std::ostream& progress);

}  // namespace adit
