// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit evaluate OUT [TRUTH]` tells of the folder of a run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/evaluation/run_page.hpp"
#include "adit/tools/evaluation/run_review.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// The run's own figures, and those against the truth where there is one.
struct RunEvaluation {
  std::filesystem::path folder;
  RunReview review;
  std::optional<RunTruth> truth;
  std::string report;  ///< for people
};

/// `truth` may be null: there is none. Throws InputError.
RunEvaluation evaluate_run(const std::filesystem::path& folder, const Trajectory* truth,
                           const EvaluationOptions& options);

/// The page with all of it. Throws OutputError.
void write_page(const RunEvaluation& evaluation, const std::filesystem::path& page);

/// For programs.
nlohmann::ordered_json to_json(const RunEvaluation& evaluation,
                               const std::filesystem::path& truth_file);

}  // namespace adit
