// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/evaluate.hpp"
#include "tools/run_review.hpp"

namespace adit {

/// States, directions, overlap, innovations, biases and gravity of a run over time, as an SVG.
/// Empty without sweeps.
std::string draw_run(const RunReview& review);

/// The same as an HTML page that needs nothing else, with what there is to say in words and, where
/// there is a truth, the trajectories and their error. `report` is the text of `adit evaluate`.
std::string run_page(const std::string& title, const std::string& report, const RunReview& review,
                     const Evaluation* evaluation);

}  // namespace adit
