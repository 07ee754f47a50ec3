// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/run_evaluation.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "adit/tools/evaluation/evaluation_report.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/run/run_loops_section.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

RunEvaluation evaluate_run(const std::filesystem::path& folder, const Trajectory* truth,
                           const EvaluationOptions& options) {
  RunEvaluation result{
      .folder = folder, .review = review_run(folder), .truth = std::nullopt, .report = {}};
  result.report = describe(result.review);
  if (truth == nullptr) {
    return result;
  }
  const Trajectory estimate = read_trajectory(RunFiles(folder).tum);
  RunTruth found{
      .evaluation = evaluate(estimate, *truth, options),
      .consistency = pose_consistency(result.review, estimate, *truth, options.tolerance)};
  result.report += found.consistency ? describe(*found.consistency) : "";
  result.report += "\n" + format_evaluation(found.evaluation, estimate.file, truth->file);
  result.truth = std::move(found);
  return result;
}

void write_page(const RunEvaluation& evaluation, const std::filesystem::path& page) {
  const LoopsSection loops = run_loops_section(RunFiles(evaluation.folder));
  const std::string section =
      loops.headline.empty() ? "" : "<h2>" + loops.headline + "</h2>\n" + loops.body;
  write_text_file(page, run_page(evaluation.folder.string(), evaluation.report, evaluation.review,
                                 evaluation.truth ? &*evaluation.truth : nullptr, section));
}

nlohmann::ordered_json to_json(const RunEvaluation& evaluation,
                               const std::filesystem::path& truth_file) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (evaluation.truth) {
    json = nlohmann::ordered_json::parse(
        evaluation_json(evaluation.truth->evaluation, RunFiles(evaluation.folder).tum, truth_file));
    if (evaluation.truth->consistency) {
      json["consistency"] = to_json(*evaluation.truth->consistency);
    }
  }
  json["run"] = to_json(evaluation.review);
  return json;
}

}  // namespace adit
