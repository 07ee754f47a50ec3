// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/command_evaluate.hpp"

#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/evaluation_plot.hpp"
#include "tools/evaluation_report.hpp"

namespace adit {
namespace {

/// An option whose value is one of a few words; the first is the default.
template <class T>
void add_choice(CLI::App& command, const std::string& name, const std::string& description,
                T& target, const std::vector<std::pair<std::string, T>>& choices) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& [word, value] : choices) {
    words.push_back(word);
  }
  command
      .add_option_function<std::string>(
          name,
          [&target, choices](const std::string& word) {
            for (const auto& [candidate, value] : choices) {
              if (candidate == word) {
                target = value;
              }
            }
          },
          description)
      ->check(CLI::IsMember(words))
      ->default_str(words.front());
}

}  // namespace

int evaluate_command(const EvaluateCommandOptions& options, std::ostream& out, std::ostream& err) {
  try {
    const Trajectory estimate = read_trajectory(options.estimate, options.estimate_times);
    const Trajectory truth = read_trajectory(options.truth, options.truth_times);
    const Evaluation evaluation = evaluate(estimate, truth, options.evaluation);
    if (options.json) {
      out << evaluation_json(evaluation, options.estimate, options.truth);
    } else {
      out << format_evaluation(evaluation, options.estimate, options.truth);
    }
    if (options.plot) {
      const std::string title =
          options.estimate.filename().string() + " against " + options.truth.filename().string();
      write_text_file(*options.plot, plot_evaluation(evaluation, title));
    }
    if (!out.flush()) {
      err << "adit evaluate: the report cannot be written to the standard output.\n";
      return 1;
    }
    return 0;
  } catch (const FileError& error) {
    err << "adit evaluate: " << error.what() << "\n";
    return 1;
  }
}

CLI::App* add_evaluate_command(CLI::App& app, std::function<void(int)> done) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "How far a trajectory is from the truth: ATE, RPE, KITTI segments");
  const auto options = std::make_shared<EvaluateCommandOptions>();
  RpeOptions& rpe = options->evaluation.rpe;
  command->add_option("estimate", options->estimate, "Trajectory to judge, TUM or KITTI format")
      ->required()
      ->type_name("ESTIMATE");
  command->add_option("truth", options->truth, "True trajectory, TUM or KITTI format")
      ->required()
      ->type_name("TRUTH");
  add_choice<Alignment>(*command, "--align", "How the estimate is moved onto the truth",
                        options->evaluation.alignment,
                        {{"se3", Alignment::se3},
                         {"sim3", Alignment::sim3},
                         {"origin", Alignment::origin},
                         {"none", Alignment::none}});
  command
      ->add_option("--tolerance", options->evaluation.tolerance,
                   "Largest time difference of a matched pair, s")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--estimate-times", options->estimate_times,
                      "Times of a KITTI estimate, one a line");
  command->add_option("--truth-times", options->truth_times, "Times of a KITTI truth, one a line");
  const CLI::Option* delta =
      command->add_option("--delta", rpe.delta, "RPE: distance between the poses of a pair")
          ->check(CLI::PositiveNumber)
          ->capture_default_str();
  add_choice<DeltaUnit>(*command, "--delta-unit", "RPE: metres of path or frames", rpe.unit,
                        {{"m", DeltaUnit::metres}, {"f", DeltaUnit::frames}});
  add_choice<PairSource>(*command, "--pairs", "RPE: whose path measures the metres", rpe.pairs_from,
                         {{"estimate", PairSource::estimate}, {"truth", PairSource::truth}});
  command->add_flag(
      "--from-first-pose", rpe.from_first_pose,
      "RPE: begin the first pair at the first pose, as evo does from version 1.37 on");
  command->add_flag("--json", options->json, "Report as JSON");
  command->add_option("--plot", options->plot,
                      "Write both trajectories and the error as an SVG file");
  command->callback([options, delta, done = std::move(done)]() {
    RpeOptions& chosen = options->evaluation.rpe;
    if (chosen.unit == DeltaUnit::frames) {
      chosen.delta = delta->count() == 0 ? 1.0 : chosen.delta;
      if (chosen.delta != std::floor(chosen.delta) || chosen.delta > 1e9) {
        throw CLI::ValidationError("--delta", "must be a whole number of frames");
      }
    }
    done(evaluate_command(*options, std::cout, std::cerr));
  });
  return command;
}

}  // namespace adit
