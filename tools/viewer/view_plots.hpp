// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run says of itself over time, for the small plots above the time line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>

#include <nlohmann/json_fwd.hpp>

#include "adit/tools/viewer/view_graph.hpp"

namespace adit {

/// No more are told of a curve, however long the run was: a page is hardly wider.
inline constexpr std::size_t kMostPlotBins = 1024;

/// "plots" of a scene, by `sweeps.csv` and `summary.json` of a run's folder: curves with the least
/// and the most of each of so many equal times (null: nothing is known), and stretches that the run
/// does not vouch for. Null where there is no sweeps.csv; one that is damaged is told to
/// `progress`.
nlohmann::ordered_json plots_of(const std::filesystem::path& folder, const ViewSpan& span,
                                std::ostream& progress);

}  // namespace adit
