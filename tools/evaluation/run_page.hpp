// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/evaluation/pose_consistency.hpp"
#include "adit/tools/evaluation/run_review.hpp"

namespace adit {

/// A run beside its truth.
struct RunTruth {
  Evaluation evaluation;
  std::optional<PoseConsistency> consistency;
};

/// States, directions, overlap, innovations, biases, gravity and uncertainty of a run over time, as
/// an SVG of that width (px). Empty without sweeps.
std::string draw_run(const RunReview& review, double width);

/// The errors of a run's poses within bounds of three sigma over time, as an SVG.
std::string draw_consistency(const RunReview& review, const PoseConsistency& consistency,
                             double width);

/// Both as an HTML page that needs nothing else, with what there is to say in words and, where
/// there is a truth, the trajectories and their error. `report` is the text of `adit evaluate`;
/// `more`, which is HTML, stands before what goes over time.
std::string run_page(const std::string& title, const std::string& report, const RunReview& review,
                     const RunTruth* truth, const std::string& more = {});

}  // namespace adit
