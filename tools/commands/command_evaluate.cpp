// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_evaluate.hpp"

#include <cmath>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/evaluation/edge_consistency.hpp"
#include "adit/tools/evaluation/evaluation_plot.hpp"
#include "adit/tools/evaluation/evaluation_report.hpp"
#include "adit/tools/evaluation/run_evaluation.hpp"
#include "adit/tools/evaluation/run_loops.hpp"
#include "adit/tools/evaluation/run_page.hpp"
#include "adit/tools/evaluation/trajectory_source.hpp"
#include "adit/tools/evaluation/world_error.hpp"
#include "adit/tools/export/wanted_system.hpp"
#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr double kLargest = 1e9;  // of --tolerance (s) and --delta

/// A picture is what its name says.
void check_plot(const EvaluateCommandOptions& options) {
  if (options.plot && options.plot->extension() != ".svg" && options.plot->extension() != ".html") {
    throw UsageError("--plot " + options.plot->string() +
                     ": a drawing is written as NAME.svg, or as a page NAME.html. Browsers, "
                     "Inkscape and rsvg-convert turn them into PNG and PDF.");
  }
}

/// Options of one side of the comparison, "estimate" or "truth".
struct SideOptions {
  std::string side;
  bool times = false;
  bool topic = false;
};

/// Throws UsageError where none of the side's trajectories has a use for what is given.
void require_use(const SideOptions& given, std::span<const fs::path> paths) {
  const auto none = [&](bool SourceUse::*what) {
    return std::ranges::none_of(paths, [&](const fs::path& path) {
      try {
        return use_of(path).*what;
      } catch (const FileError&) {
        return true;  // reported where it is read
      }
    });
  };
  const std::string whose =
      paths.size() > 1 ? "each of the " + given.side + "s " : paths.front().string() + " ";
  if (given.times && none(&SourceUse::times)) {
    throw UsageError("--" + given.side + "-times: " + whose +
                     "has times of its own; leave it out.");
  }
  if (given.topic && none(&SourceUse::topic)) {
    throw UsageError("--" + given.side + "-topic: " + whose +
                     "is a file without topics; leave it out.");
  }
}

void write_plot(const EvaluateCommandOptions& options, std::span<const PlottedEstimate> estimates,
                const std::string& title, const std::string& report) {
  if (!options.plot) {
    return;
  }
  const auto draw = [&](double width) {
    return estimates.size() == 1 ? plot_evaluation(*estimates[0].evaluation, title, width)
                                 : plot_evaluations(estimates, title, width);
  };
  const bool page = options.plot->extension() == ".html";
  write_text_file(*options.plot, page ? html_page(title, html_text(report) + html_drawing(draw))
                                      : draw(kDeskWidth));
}

Trajectory read_estimate(const EvaluateCommandOptions& options, const fs::path& path) {
  return read_any_trajectory(
      {.path = path, .times = options.estimate_times, .topic = options.estimate_topic});
}

Trajectory read_truth(const EvaluateCommandOptions& options) {
  return read_any_trajectory(
      {.path = options.truth, .times = options.truth_times, .topic = options.truth_topic});
}

/// "a.tum against truth.tum".
std::string title_of(const std::string& estimate, const fs::path& truth) {
  return estimate + " against " + short_names({truth}).front();
}

/// The report with the name and version of its schema before it (docs/schemas).
nlohmann::ordered_json with_schema(const nlohmann::ordered_json& report) {
  nlohmann::ordered_json json = {{"schema", "evaluate/1"}};
  json.update(report);
  return json;
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void evaluate_trajectory(const EvaluateCommandOptions& options, std::ostream& out) {
  const fs::path& path = options.estimates.front();
  const Trajectory estimate = read_estimate(options, path);
  const Trajectory truth = read_truth(options);
  const Evaluation evaluation = evaluate(estimate, truth, options.evaluation);
  const std::string report = format_evaluation(evaluation, estimate.file, truth.file);
  if (options.json) {
    out << json_text(with_schema(
        nlohmann::ordered_json::parse(evaluation_json(evaluation, estimate.file, truth.file))));
  } else {
    out << report;
  }
  out << std::flush;
  const PlottedEstimate plotted{"estimate", &evaluation};
  write_plot(options, std::span(&plotted, 1), title_of(short_names({path}).front(), options.truth),
             report);
}

/// What is missing of a run that did not end is missing for that reason.
RunEvaluation evaluate_as_far_as_it_went(const fs::path& folder, const Trajectory* truth,
                                         const EvaluationOptions& options) {
  try {
    return evaluate_run(folder, truth, options);
  } catch (const FileError& error) {
    const RunReview review = review_run(folder);
    if (!review.ending || review.ending->status == "completed") {
      throw;
    }
    throw FileError(folder, folder.string() + ": " +
                                describe(*review.ending, review.sweeps.size()) + ". " +
                                error.what());
  }
}

/// Of --world.
Geodetic world_origin(std::span<const double> numbers) {
  return {.latitude = numbers[0], .longitude = numbers[1], .altitude = numbers[2]};
}

/// The run's own figures, those against the truth if there is one, and the page with both.
void evaluate_folder(const EvaluateCommandOptions& options, std::ostream& out, std::ostream& err) {
  const fs::path& folder = options.estimates.front();
  const fs::path page = options.html.value_or(folder / "evaluation.html");
  std::optional<Trajectory> truth;
  if (!options.truth.empty()) {
    truth = read_truth(options);
  }
  const RunEvaluation found =
      evaluate_as_far_as_it_went(folder, truth ? &*truth : nullptr, options.evaluation);
  std::optional<EdgeConsistency> edges;
  const fs::path map = RunFiles(folder).database;
  std::error_code none;
  if (truth && fs::exists(map, none)) {
    edges = edge_consistency(map, *truth);
  }
  std::optional<RunLoops> loops;
  if (options.loops && truth) {
    loops = evaluate_loops(folder, *truth, *options.loops, options.evaluation.tolerance);
    for (const std::string& warning : warnings_of(loops->score)) {
      err << "adit evaluate: warning: " << warning << std::endl;
    }
  }
  std::optional<WorldError> world;
  if (!options.world.empty() && truth) {
    world = world_error(map, *truth, world_origin(options.world), options.evaluation.tolerance);
  }
  write_page(found, page);
  if (options.json) {
    nlohmann::ordered_json json = with_schema(to_json(found, truth ? truth->file : fs::path()));
    if (edges) {
      json["map_edges"] = to_json(*edges);
    }
    if (loops) {
      json["loops"] = to_json(*loops);
    }
    if (world) {
      json["world"] = to_json(*world);
    }
    out << json_text(json) << std::flush;
  } else {
    out << found.report << "\n"
        << (edges ? describe(*edges) : "") << (loops ? describe(*loops) : "")
        << (world ? describe(*world) : "") << "look at      " << page.string() << "\n"
        << std::flush;
  }
  if (found.truth) {
    const PlottedEstimate plotted{"estimate", &found.truth->evaluation};
    write_plot(options, std::span(&plotted, 1),
               title_of(short_names({folder}).front(), options.truth), found.report);
  }
}

/// An estimate that cannot be compared is noted, and the others are compared.
ComparedEstimate compare(const EvaluateCommandOptions& options, const fs::path& path,
                         const std::string& name, const Trajectory& truth) {
  ComparedEstimate result{.name = name, .evaluation = std::nullopt, .note = {}};
  try {
    if (holds_a_run(path)) {
      const RunReview review = review_run(path);
      if (review.ending && review.ending->status != "completed") {
        result.note = describe(*review.ending, review.sweeps.size());
      }
    }
    result.evaluation = evaluate(read_estimate(options, path), truth, options.evaluation);
  } catch (const FileError& error) {
    result.note += (result.note.empty() ? "" : "; ") + std::string(error.what());
  }
  return result;
}

nlohmann::ordered_json to_json(const Comparison& comparison, const EvaluateCommandOptions& options,
                               const Trajectory& truth) {
  nlohmann::ordered_json json = {{"truth", truth.file.string()},
                                 {"estimates", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < comparison.estimates.size(); ++i) {
    const ComparedEstimate& one = comparison.estimates[i];
    nlohmann::ordered_json entry = {{"name", one.name}, {"note", one.note}};
    if (one.evaluation) {
      entry.update(nlohmann::ordered_json::parse(
          evaluation_json(*one.evaluation, options.estimates[i], truth.file)));
    }
    json["estimates"].push_back(entry);
  }
  return json;
}

/// Several estimates, a line each. Returns whether all could be compared.
bool compare_estimates(const EvaluateCommandOptions& options, std::ostream& out,
                       std::ostream& err) {
  const Trajectory truth = read_truth(options);
  Comparison comparison{.truth = truth.file.string(), .estimates = {}};
  const std::vector<std::string> names = short_names(options.estimates);
  std::vector<PlottedEstimate> plotted;
  for (std::size_t i = 0; i < names.size(); ++i) {
    comparison.estimates.push_back(compare(options, options.estimates[i], names[i], truth));
  }
  for (const ComparedEstimate& one : comparison.estimates) {
    if (one.evaluation) {
      plotted.push_back({one.name, &*one.evaluation});
    }
  }
  const TableFormat format = options.table.value_or(TableFormat::text);
  const std::string table = to_table(comparison, format);
  const std::string notes = notes_of(comparison);
  if (options.json) {
    out << json_text(with_schema(to_json(comparison, options, truth))) << std::flush;
  } else {
    out << (format == TableFormat::text ? "truth  " + comparison.truth + "\n\n" : "") << table
        << std::flush;
    err << notes;
  }
  if (!plotted.empty()) {
    write_plot(options, plotted,
               title_of(std::to_string(names.size()) + " estimates", options.truth),
               to_table(comparison, TableFormat::text) + notes);
  }
  return comparison.complete();
}

int run(const EvaluateCommandOptions& options, std::ostream& out, std::ostream& err) {
  check_plot(options);
  if (!options.world.empty()) {
    require_place("--world", world_origin(options.world));
  }
  require_use({.side = "estimate",
               .times = options.estimate_times.has_value(),
               .topic = !options.estimate_topic.empty()},
              options.estimates);
  if (!options.truth.empty()) {
    require_use({.side = "truth",
                 .times = options.truth_times.has_value(),
                 .topic = !options.truth_topic.empty()},
                std::span(&options.truth, 1));
  }
  if (options.estimates.size() > 1 || options.table) {
    return compare_estimates(options, out, err) ? 0 : 1;
  }
  if (is_run(options.estimates.front())) {
    evaluate_folder(options, out, err);
  } else {
    evaluate_trajectory(options, out);
  }
  return 0;
}

}  // namespace

int evaluate_command(const EvaluateCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit evaluate", out, err, [&] { return run(options, out, err); });
}

void add_evaluate_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command(
      "evaluate", "How far a trajectory is from the truth: ATE, RPE, KITTI segments");
  const auto options = std::make_shared<EvaluateCommandOptions>();
  RpeOptions& rpe = options->evaluation.rpe;
  command.footer(
      "Trajectories are read from TUM or KITTI text, tables with named columns (EuRoC's data.csv,\n"
      "sweeps.csv, the simulator's truth.csv), folders of runs, and the poses in any recording "
      "that\n"
      "`adit run` reads. Of several estimates each gets a line of one table and a curve in one "
      "plot.\n\n"
      "OUT, the folder of a run, can stand for ESTIMATE: then states, weakly held directions,\n"
      "innovations, biases, gravity and how well poses are known are told as well and drawn on a\n"
      "page, with or without a truth; with one also whether the covariances are true (NEES).\n\n"
      "Examples:\n"
      "  adit evaluate out/trajectory.tum truth.tum --plot error.svg\n"
      "  adit evaluate out\n"
      "  adit evaluate out truth.tum --html page.html\n"
      "  adit evaluate out mine.truth.tum --loops mine.truth.loops.csv\n"
      "  adit evaluate out mav0/state_groundtruth_estimate0/data.csv\n"
      "  adit evaluate out drive.bag --truth-topic /odom\n"
      "  adit evaluate ours theirs.tum others.txt truth.tum --markdown --plot all.svg\n\n"
      "Exit codes: 0 done, 1 failed on the data, 2 usage.");
  const auto paths = std::make_shared<std::vector<fs::path>>();
  command
      .option("trajectories", *paths,
              "What to judge, and last the truth; the folder of one run needs none")
      .required()
      .value_name("ESTIMATE... TRUTH");
  command
      .choice<Alignment>("--align", "How the estimate is moved onto the truth",
                         options->evaluation.alignment,
                         {{"se3", Alignment::se3},
                          {"sim3", Alignment::sim3},
                          {"origin", Alignment::origin},
                          {"none", Alignment::none}})
      .show_default("se3");
  command
      .option("--part", options->evaluation.part,
              "Which part of an estimate whose odometry started anew; their common alignment is "
              "refused")
      .value_name("N");
  command
      .option("--tolerance", options->evaluation.tolerance,
              "Largest time difference of a matched pair (s)")
      .from(0.0, kLargest)
      .value_name("S")
      .show_default();
  command
      .option("--estimate-times", options->estimate_times, "Times of KITTI estimates, one a line")
      .value_name("FILE");
  command.option("--truth-times", options->truth_times, "Times of a KITTI truth, one a line")
      .value_name("FILE");
  command
      .option("--estimate-topic", options->estimate_topic,
              "Which poses of a recording to judge; NAME:FRAME of a topic with several frames")
      .value_name("NAME");
  command.option("--truth-topic", options->truth_topic, "Which poses of a recording are the truth")
      .value_name("NAME");
  const CommandOption delta =
      command.option("--delta", rpe.delta, "RPE: distance between the poses of a pair")
          .above(0.0)
          .from(0.0, kLargest)
          .value_name("D")
          .show_default();
  command
      .choice<DeltaUnit>("--delta-unit", "RPE: metres of path or frames", rpe.unit,
                         {{"m", DeltaUnit::metres}, {"f", DeltaUnit::frames}})
      .show_default("m");
  command
      .choice<PairSource>("--pairs", "RPE: whose path measures the metres", rpe.pairs_from,
                          {{"estimate", PairSource::estimate}, {"truth", PairSource::truth}})
      .show_default("estimate");
  command.flag("--from-first-pose", rpe.from_first_pose,
               "RPE: begin the first pair at the first pose, as evo does from version 1.37 on");
  const auto forms = std::make_shared<std::vector<std::string>>();  // those that are given
  command.flag(
      "--json",
      [options, forms] {
        options->json = true;
        forms->emplace_back("--json");
      },
      "Report as JSON");
  const auto add_format = [&](const std::string& name, TableFormat format,
                              const std::string& description) {
    command.flag(
        name,
        [options, forms, name, format] {
          options->table = format;
          forms->push_back(name);
        },
        description);
  };
  add_format("--table", TableFormat::text, "A line an estimate, also of a single one");
  add_format("--markdown", TableFormat::markdown, "The table as Markdown");
  add_format("--latex", TableFormat::latex, "The table for LaTeX");
  add_format("--csv", TableFormat::csv, "The table as CSV, with all digits");
  command
      .option("--plot", options->plot,
              "Draw the trajectories and their errors, into NAME.svg or NAME.html")
      .value_name("FILE")
      .written();
  command
      .option("--html", options->html,
              "Where the page of a run goes; otherwise to its folder, as evaluation.html")
      .value_name("FILE.html")
      .written({".html", ".htm"});
  command
      .option("--loops", options->loops,
              "Which places of a simulated recording see the same (NAME.truth.loops.csv): the "
              "loops of a run's map are scored")
      .value_name("FILE");
  command
      .option(
          "--world", options->world,
          "The truth's frame is east, north and up at this place: a run's map is compared in the "
          "world, without any alignment")
      .values(3, 3)
      .value_name("LAT LON ALT");
  command.action([command, options, paths, forms, delta, done = std::move(done)]() {
    if (forms->size() > 1) {
      throw UsageError(forms->front() + " and " + (*forms)[1] + " exclude each other.");
    }
    RpeOptions& chosen = options->evaluation.rpe;
    if (chosen.unit == DeltaUnit::frames) {
      chosen.delta = !delta.given() ? 1.0 : chosen.delta;
      if (chosen.delta != std::floor(chosen.delta)) {
        refuse_option("--delta", "must be a whole number of frames");
      }
    }
    const bool alone = paths->size() == 1;
    const bool run = is_run(paths->front());
    std::error_code unknown;
    if (alone && !run && fs::is_directory(paths->front(), unknown)) {
      refuse_option(paths->front().string(),
                    "is no folder of a run: it has neither summary.json nor sweeps.csv. A run that "
                    "was stopped before it began leaves none; a recording's poses need a TRUTH");
    }
    if (alone && !run) {
      miss_argument("TRUTH");
    }
    const std::string needing = command.given_besides({"trajectories", "--json", "--html"});
    if (alone && !needing.empty()) {
      refuse_option(needing, "needs a TRUTH, behind the folder of the run");
    }
    options->estimates.assign(paths->begin(), alone ? paths->end() : paths->end() - 1);
    options->truth = alone ? fs::path() : paths->back();
    if (options->html && (!run || options->estimates.size() > 1)) {
      refuse_option("--html", "needs the folder of a run; `--plot NAME.html` draws trajectories");
    }
    if (!options->world.empty() && (!run || alone || options->estimates.size() > 1)) {
      refuse_option("--world", "needs the folder of a run and the truth");
    }
    if (options->loops && (!run || alone || options->estimates.size() > 1)) {
      refuse_option("--loops", "needs the folder of a run and the truth");
    }
    if (options->table && (options->html || options->loops || !options->world.empty())) {
      refuse_option(forms->front(),
                    "has a line an estimate; leave out --html, --loops and --world");
    }
    done(evaluate_command(*options, std::cout, std::cerr));
  });
}

}  // namespace adit
