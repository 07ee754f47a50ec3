// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "adit/tools/drawing/svg.hpp"
#include "adit/tools/evaluation/evaluate.hpp"

namespace adit {

struct PlottedEstimate {
  std::string name;  ///< for the legend
  const Evaluation* evaluation = nullptr;
};

/// Evaluations beside one truth as an SVG file: the trajectories from above (the two axes in which
/// the truth extends farthest, equal scale), and below them the position errors over the distance
/// travelled. `title` names what was compared. At least one estimate.
std::string plot_evaluations(std::span<const PlottedEstimate> estimates, const std::string& title,
                             double width = kDeskWidth);

/// The same of one estimate, with its figures.
std::string plot_evaluation(const Evaluation& evaluation, const std::string& title,
                            double width = kDeskWidth);

}  // namespace adit
