// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/command_demo.hpp"

#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include "tools/command_guard.hpp"
#include "tools/command_run.hpp"
#include "tools/evaluate.hpp"
#include "tools/evaluation_plot.hpp"
#include "tools/map_picture.hpp"
#include "tools/output_file.hpp"
#include "tools/progress.hpp"
#include "tools/recordings/ply_reader.hpp"
#include "tools/simulator/simulation.hpp"
#include "tools/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Along the first drifts, with a lidar of 64 beams.
SimulationFiles simulate_mine(const DemoCommandOptions& options, std::ostream& err) {
  std::error_code error;
  fs::create_directories(options.output, error);
  if (error) {
    throw OutputError(options.output, options.output.string() + ": the folder cannot be made: " +
                                          error.message() + ". Choose another one with -o.");
  }
  SimulationOptions simulation;
  simulation.scene = "mine";
  simulation.lidars.front().sensor = "OS1-64";
  simulation.lidars.front().layout = CloudLayout::velodyne;  // half the size of Ouster's
  simulation.compression = Compression::zstd;
  simulation.duration = options.duration;
  simulation.output = options.output / "mine.mcap";
  std::optional<Progress> progress;
  simulate(simulation, [&](std::size_t done, std::size_t total) {
    if (!progress) {
      progress.emplace(err, options.quiet ? ProgressStyle::none : progress_style_of_stderr(),
                       "simulating", total);
    }
    progress->update(done, 0);
  });
  if (progress) {
    progress->finish();
  }
  return SimulationFiles(simulation.output);
}

void write_pictures(const fs::path& folder, const Trajectory& estimate,
                    const Evaluation& evaluation) {
  const CloudFile map = read_ply(RunFiles(folder).map);
  write_text_file(folder / "map.svg", map_picture(map.sweep.points, estimate.poses));
  write_text_file(folder / "evaluation.svg", plot_evaluation(evaluation, "adit demo"));
}

std::string verdict(const Evaluation& evaluation, bool good) {
  char text[256];
  std::snprintf(text, sizeof text,
                "error    %.3f m (ATE, rmse over %zu poses, SE(3)-aligned; %.3f m at most), bound "
                "%.2f m: %s\n",
                evaluation.ate.rmse, evaluation.ate.count, evaluation.ate.max, kDemoErrorBound,
                good ? "good" : "TOO LARGE");
  return text;
}

int demo(const DemoCommandOptions& options, std::ostream& out, std::ostream& err) {
  if (!(options.duration >= 3.0)) {
    throw UsageError("--duration: at least 3 s are needed; the drive begins at rest.");
  }
  const SimulationFiles files = simulate_mine(options, err);
  RunCommandOptions run;
  run.recording = files.recording;
  run.output = options.output;
  run.device = options.device;
  run.quiet = options.quiet;
  const int code = run_command(run, out, err);
  if (code != 0) {
    return code;
  }
  const Trajectory estimate = read_trajectory(RunFiles(options.output).tum);
  const Evaluation evaluation = evaluate(estimate, read_trajectory(files.trajectory), {});
  write_pictures(options.output, estimate, evaluation);
  const bool good = evaluation.ate.rmse <= kDemoErrorBound;
  if (!options.quiet) {
    const std::string folder = options.output.string();
    out << verdict(evaluation, good) << "look at  " << folder << "/map.svg (from above), " << folder
        << "/evaluation.svg (against the truth), " << folder
        << "/map.ply (any point cloud viewer),\n         " << files.picture.string()
        << " (the mine)\n"
        << "again    adit run " << files.recording.string() << " -o OUT\n"
        << "         adit evaluate OUT/trajectory.tum " << files.trajectory.string() << std::endl;
  }
  if (!good) {
    err << "adit demo: the error " << evaluation.ate.rmse << " m is above " << kDemoErrorBound
        << " m" << std::endl;
  }
  return good ? 0 : 1;
}

}  // namespace

int demo_command(const DemoCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit demo", out, err, [&] { return demo(options, out, err); });
}

CLI::App* add_demo_command(CLI::App& app, std::function<void(int)> done) {
  auto options = std::make_shared<DemoCommandOptions>();
  CLI::App* command =
      app.add_subcommand("demo", "Simulate a mine, map it, and compare the result with the truth");
  command->footer(
      "A vehicle with a 64-beam lidar drives through a mine. Nothing is needed but a device; "
      "`adit simulate`\nmakes longer recordings, of other places.\n\n"
      "Examples:\n"
      "  adit demo\n"
      "  adit demo -o /tmp/demo --device 0\n\n"
      "Exit codes: 0 done, 1 failed or not accurate, 2 usage.");
  command
      ->add_option("-o,--output", options->output,
                   "Folder for recording and results; made if need be")
      ->type_name("OUT")
      ->capture_default_str();
  command->add_option("--duration", options->duration, "Length of the drive (s)")
      ->type_name("S")
      ->capture_default_str();
  add_device_options(*command, options->device);
  command->add_flag("--quiet", options->quiet, "Print errors alone");
  command->callback(
      [options, done = std::move(done)] { done(demo_command(*options, std::cout, std::cerr)); });
  return command;
}

}  // namespace adit
