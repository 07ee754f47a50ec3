// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The loops of a run, and what they did to its trajectory.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/tools/evaluation/loop_score.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// ATE (m, rmse), aligned by SE(3); none where there is no trajectory, or none that an alignment
/// can be told from. Parts of an odometry that started anew count as one.
struct LoopAte {
  std::optional<double> odometry{};  ///< what no loop corrects
  std::optional<double> map{};
};

/// What loops did to a trajectory.
struct LoopEffect {
  LoopAte all{};
  LoopAte in_span{};       ///< of what lies in the span of right loops, aligned by that alone
  double span_path = 0.0;  ///< m of the truth in it; 0: there is no right loop
};

/// A file that is not there is no trajectory. `tolerance` (s) is the largest time difference of a
/// matched pair. Throws InputError for files that cannot be read.
LoopEffect loop_effect(const std::filesystem::path& odometry, const std::filesystem::path& map,
                       const Trajectory& truth, const std::optional<LoopSpan>& span,
                       double tolerance);

struct RunLoops {
  LoopScore score;
  LoopEffect effect;
};

/// Of the run in that folder; `loops` is the table of the places that see the same. Throws
/// InputError.
RunLoops evaluate_loops(const std::filesystem::path& folder, const Trajectory& truth,
                        const std::filesystem::path& loops, double tolerance);

std::string describe(const RunLoops& loops);
nlohmann::ordered_json to_json(const RunLoops& loops);

}  // namespace adit
