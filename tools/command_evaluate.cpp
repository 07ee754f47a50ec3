// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/command_evaluate.hpp"

#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/command_guard.hpp"
#include "tools/evaluation/run_evaluation.hpp"
#include "tools/evaluation_plot.hpp"
#include "tools/evaluation_report.hpp"
#include "tools/support/option_values.hpp"

namespace adit {
namespace {

void write_plot(const EvaluateCommandOptions& options, const Evaluation& evaluation) {
  if (options.plot) {
    const std::string title =
        options.estimate.filename().string() + " against " + options.truth.filename().string();
    write_text_file(*options.plot, plot_evaluation(evaluation, title));
  }
}

Trajectory read_truth(const EvaluateCommandOptions& options) {
  return read_trajectory(options.truth, options.truth_times);
}

void evaluate_trajectory(const EvaluateCommandOptions& options, std::ostream& out) {
  const Evaluation evaluation = evaluate(read_trajectory(options.estimate, options.estimate_times),
                                         read_truth(options), options.evaluation);
  out << (options.json ? evaluation_json(evaluation, options.estimate, options.truth)
                       : format_evaluation(evaluation, options.estimate, options.truth))
      << std::flush;
  write_plot(options, evaluation);
}

/// The run's own figures, those against the truth if there is one, and the page with both.
void evaluate_folder(const EvaluateCommandOptions& options, std::ostream& out) {
  const std::filesystem::path page = options.html.value_or(options.estimate / "evaluation.html");
  std::optional<Trajectory> truth;
  if (!options.truth.empty()) {
    truth = read_truth(options);
  }
  const RunEvaluation found =
      evaluate_run(options.estimate, truth ? &*truth : nullptr, options.evaluation);
  write_page(found, page);
  out << (options.json ? to_json(found, options.truth).dump(2) + "\n"
                       : found.report + "\nlook at      " + page.string() + "\n")
      << std::flush;
  if (found.truth) {
    write_plot(options, found.truth->evaluation);
  }
}

}  // namespace

int evaluate_command(const EvaluateCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit evaluate", out, err, [&] {
    std::error_code unknown;
    if (std::filesystem::is_directory(options.estimate, unknown)) {
      evaluate_folder(options, out);
    } else {
      evaluate_trajectory(options, out);
    }
    return 0;
  });
}

CLI::App* add_evaluate_command(CLI::App& app, std::function<void(int)> done) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "How far a trajectory is from the truth: ATE, RPE, KITTI segments");
  const auto options = std::make_shared<EvaluateCommandOptions>();
  RpeOptions& rpe = options->evaluation.rpe;
  command->footer(
      "OUT, the folder of a run, can stand for ESTIMATE: then states, weakly held directions,\n"
      "innovations, biases, gravity and how well poses are known are told as well and drawn on a\n"
      "page, with or without a truth; with one also whether the covariances are true (NEES).\n\n"
      "Examples:\n"
      "  adit evaluate out/trajectory.tum truth.tum --plot error.svg\n"
      "  adit evaluate out\n"
      "  adit evaluate out truth.tum --html page.html\n\n"
      "Exit codes: 0 done, 1 failed on the data, 2 usage.");
  command
      ->add_option("estimate", options->estimate,
                   "Trajectory to judge, TUM or KITTI format, or the folder of a run")
      ->required()
      ->type_name("ESTIMATE");
  command->add_option("truth", options->truth, "True trajectory, TUM or KITTI format")
      ->type_name("TRUTH");
  add_choice<Alignment, Alignment>(*command, "--align", "How the estimate is moved onto the truth",
                                   options->evaluation.alignment,
                                   {{"se3", Alignment::se3},
                                    {"sim3", Alignment::sim3},
                                    {"origin", Alignment::origin},
                                    {"none", Alignment::none}})
      ->default_str("se3");
  command
      ->add_option("--tolerance", options->evaluation.tolerance,
                   "Largest time difference of a matched pair (s)")
      ->check(number_from(0.0))
      ->type_name("S")
      ->capture_default_str();
  command
      ->add_option("--estimate-times", options->estimate_times,
                   "Times of a KITTI estimate, one a line")
      ->type_name("FILE");
  command->add_option("--truth-times", options->truth_times, "Times of a KITTI truth, one a line")
      ->type_name("FILE");
  const CLI::Option* delta =
      command->add_option("--delta", rpe.delta, "RPE: distance between the poses of a pair")
          ->check(number_above(0.0))
          ->type_name("D")
          ->capture_default_str();
  add_choice<DeltaUnit, DeltaUnit>(*command, "--delta-unit", "RPE: metres of path or frames",
                                   rpe.unit, {{"m", DeltaUnit::metres}, {"f", DeltaUnit::frames}})
      ->default_str("m");
  add_choice<PairSource, PairSource>(
      *command, "--pairs", "RPE: whose path measures the metres", rpe.pairs_from,
      {{"estimate", PairSource::estimate}, {"truth", PairSource::truth}})
      ->default_str("estimate");
  command->add_flag(
      "--from-first-pose", rpe.from_first_pose,
      "RPE: begin the first pair at the first pose, as evo does from version 1.37 on");
  command->add_flag("--json", options->json, "Report as JSON");
  command
      ->add_option("--plot", options->plot, "Write both trajectories and the error as an SVG file")
      ->type_name("FILE");
  command
      ->add_option("--html", options->html,
                   "Where the page of a run goes; otherwise to its folder, as evaluation.html")
      ->type_name("FILE");
  command->callback([options, delta, done = std::move(done)]() {
    RpeOptions& chosen = options->evaluation.rpe;
    if (chosen.unit == DeltaUnit::frames) {
      chosen.delta = delta->count() == 0 ? 1.0 : chosen.delta;
      if (chosen.delta != std::floor(chosen.delta) || chosen.delta > 1e9) {
        throw CLI::ValidationError("--delta", "must be a whole number of frames");
      }
    }
    std::error_code unknown;
    const bool run = std::filesystem::is_directory(options->estimate, unknown);
    if (options->truth.empty() && (!run || options->plot)) {
      throw CLI::RequiredError("TRUTH");
    }
    if (options->html && !run) {
      throw CLI::ValidationError("--html", "needs the folder of a run instead of a trajectory");
    }
    done(evaluate_command(*options, std::cout, std::cerr));
  });
  return command;
}

}  // namespace adit
