// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/tools/evaluation/evaluate.hpp"

namespace adit {

/// The evaluation as an SVG file: both trajectories from above (the two axes in which the truth
/// extends farthest, equal scale), and below it the position error over the distance travelled.
/// `title` names what was compared.
std::string plot_evaluation(const Evaluation& evaluation, const std::string& title);

}  // namespace adit
