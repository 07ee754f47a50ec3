// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run says of itself over time: the small plots above the time line, and directions that
// sweeps were not held in.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string_view>

#include <nlohmann/json.hpp>

#include "adit/tools/results/run_sources.hpp"
#include "adit/tools/results/sweep_table.hpp"
#include "adit/tools/viewer/view_graph.hpp"

namespace adit {

/// No more are told of a curve, however long the run was: a page is hardly wider.
inline constexpr std::size_t kMostPlotBins = 1024;

/// No more weak directions are told of; evenly thinned.
inline constexpr std::size_t kMostWeak = 4000;

/// A curve over the time of a run.
struct PlotCurve {
  std::string_view name;
  std::string_view title;
  std::string_view unit;
  bool logarithmic = false;
  double (*value)(const SweepRecord&) = nullptr;  ///< what it is of a sweep; NaN: not known
};
inline constexpr std::size_t kPlotCurves = 4;
const std::array<PlotCurve, kPlotCurves>& plot_curves();

/// A curve by its name, without values.
nlohmann::ordered_json curve_json(const PlotCurve& curve);
/// Values of a curve: four digits, for a plot is some dozens of pixels high; null for NaN.
nlohmann::ordered_json plotted(double value);

/// Of a scene, as JSON.
struct ViewRun {
  /// Curves with the least and the most of each of so many equal times (null: nothing is known),
  /// and stretches that the run does not vouch for. Null where there is no sweeps.csv.
  nlohmann::ordered_json plots;
  /// Directions of translation that were held in part or not at all (unit, map axes), with the
  /// position of their sweep in "sweeps".
  nlohmann::ordered_json weak;
  /// What each source was worth, as summary.json has it; an empty list where it has none.
  nlohmann::ordered_json sources;
};

/// What has no `sweeps.csv`.
ViewRun no_run();

/// By `sweeps.csv` and `summary.json` of a run's folder; a table that is damaged is told to
/// `progress`, and nothing else of it. `sweeps` are those of the scene.
ViewRun run_of(const std::filesystem::path& folder, const ViewSpan& span,
               const std::vector<ViewSweep>& sweeps, std::ostream& progress);

}  // namespace adit
