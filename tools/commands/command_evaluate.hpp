// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit evaluate ESTIMATE... TRUTH`, `adit evaluate OUT [TRUTH]`.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/evaluation/comparison.hpp"
#include "adit/tools/evaluation/evaluate.hpp"

namespace adit {

class Command;

struct EvaluateCommandOptions {
  std::vector<std::filesystem::path> estimates;  ///< trajectories, or folders of runs
  std::filesystem::path truth;  ///< empty: none, which only the folder of one run can do without
  std::optional<std::filesystem::path> estimate_times{};  ///< for KITTI estimates
  std::optional<std::filesystem::path> truth_times{};     ///< for a KITTI truth
  std::string estimate_topic{};  ///< topic of the poses in a recording; empty: the only ones
  std::string truth_topic{};
  EvaluationOptions evaluation{};
  bool json = false;                            ///< JSON on `out` instead of the report
  std::optional<TableFormat> table{};           ///< one line an estimate instead of the report
  std::optional<std::filesystem::path> plot{};  ///< picture to write, .svg or .html
  /// HTML to write, of a run; none: evaluation.html in its folder.
  std::optional<std::filesystem::path> html{};
  /// Pairs of moments that see the same: scores the loops of a run's map.
  std::optional<std::filesystem::path> loops{};
  /// LAT LON ALT where the truth's frame touches the Earth; empty: not compared in the world.
  std::vector<double> world{};
};

/// Evaluates, prints the report on `out` and what went wrong on `err`. Returns the exit code: 0
/// done, 1 failed on the data, 2 usage.
int evaluate_command(const EvaluateCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command to the program. When the user calls it, it runs on std::cout and std::cerr
/// once the command line is read, and `done` gets the exit code.
void add_evaluate_command(Command app, std::function<void(int)> done);

}  // namespace adit
