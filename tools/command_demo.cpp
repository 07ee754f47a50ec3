// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/command_demo.hpp"

#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

#include "tools/command_guard.hpp"
#include "tools/command_run.hpp"
#include "tools/config_file.hpp"
#include "tools/demo_recording.hpp"
#include "tools/evaluate.hpp"
#include "tools/evaluation_plot.hpp"
#include "tools/map_picture.hpp"
#include "tools/output_file.hpp"
#include "tools/progress.hpp"
#include "tools/recordings/ply_reader.hpp"
#include "tools/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

DemoFiles simulate(const DemoCommandOptions& options, const SpinningLidar& lidar,
                   std::ostream& err) {
  const DemoDrive drive = make_demo_drive(options.sweeps);
  Progress progress(err, options.quiet ? ProgressStyle::none : progress_style_of_stderr(),
                    "simulating", options.sweeps);
  DemoFiles files = write_demo_recording(options.output, drive, lidar,
                                         [&](std::size_t done) { progress.update(done, 0); });
  progress.finish();
  return files;
}

/// The defaults, but for the spacing of the simulated lidar's beams; beside the results, for a run
/// of one's own.
fs::path write_config(const fs::path& folder, const SpinningLidar& lidar) {
  Config config;
  config.preprocess.beam_spacing = lidar.beam_spacing();
  fs::path file = folder / "config.toml";
  write_text_file(file, to_toml(config));
  return file;
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
  if (options.sweeps < 3) {
    throw UsageError("--sweeps: at least 3 are needed for an evaluation.");
  }
  const SpinningLidar lidar;
  const DemoFiles files = simulate(options, lidar, err);
  const fs::path config = write_config(options.output, lidar);
  RunCommandOptions run;
  run.recording = files.recording;
  run.output = options.output;
  run.config.file = config;
  run.device = options.device;
  run.quiet = options.quiet;
  const int code = run_command(run, out, err);
  if (code != 0) {
    return code;
  }
  const Trajectory estimate = read_trajectory(RunFiles(options.output).tum);
  const Evaluation evaluation = evaluate(estimate, read_trajectory(files.truth), {});
  write_pictures(options.output, estimate, evaluation);
  const bool good = evaluation.ate.rmse <= kDemoErrorBound;
  if (!options.quiet) {
    const std::string folder = options.output.string();
    out << verdict(evaluation, good) << "look at  " << folder << "/map.svg (from above), " << folder
        << "/evaluation.svg (against the truth), " << folder
        << "/map.ply (any point cloud viewer)\n"
        << "again    adit run " << files.recording.string() << " -o OUT --config "
        << config.string() << "\n"
        << "         adit evaluate " << folder << "/trajectory.tum " << files.truth.string()
        << std::endl;
  }
  if (!good) {
    err << "adit demo: the error " << evaluation.ate.rmse << " m is above " << kDemoErrorBound
        << " m" << std::endl;
  }
  return good ? 0 : 1;
}

}  // namespace

int demo_command(const DemoCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit demo", err, [&] { return demo(options, out, err); });
}

CLI::App* add_demo_command(CLI::App& app, std::function<void(int)> done) {
  auto options = std::make_shared<DemoCommandOptions>();
  CLI::App* command =
      app.add_subcommand("demo", "Simulate a drive, map it, and compare the result with the truth");
  command->footer(
      "A car with a 32-beam lidar drives along a street with two turns. Nothing is needed but a "
      "device.\n\n"
      "Examples:\n"
      "  adit demo\n"
      "  adit demo -o /tmp/demo --device 0\n\n"
      "Exit codes: 0 done, 1 failed or not accurate, 2 usage.");
  command
      ->add_option("-o,--output", options->output,
                   "Folder for recording and results; made if need be")
      ->type_name("OUT")
      ->capture_default_str();
  command->add_option("--sweeps", options->sweeps, "Length of the drive, ten sweeps a second")
      ->type_name("N")
      ->capture_default_str();
  add_device_options(*command, options->device);
  command->add_flag("--quiet", options->quiet, "Print errors alone");
  command->callback(
      [options, done = std::move(done)] { done(demo_command(*options, std::cout, std::cerr)); });
  return command;
}

}  // namespace adit
