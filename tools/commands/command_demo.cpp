// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_demo.hpp"

#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_line.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/drawing/map_picture.hpp"
#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/evaluation/evaluation_plot.hpp"
#include "adit/tools/evaluation/run_evaluation.hpp"
#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Along the first drifts, with a lidar of 64 beams.
void simulate_mine(const SimulationFiles& files, const DemoCommandOptions& options,
                   std::ostream& err) {
  SimulationOptions simulation;
  simulation.scene = "mine";
  simulation.lidars.front().sensor = "OS1-64";
  simulation.lidars.front().layout = CloudLayout::velodyne;  // half the size of Ouster's
  simulation.compression = Compression::zstd;
  simulation.duration = options.duration;
  simulation.output = files.recording;
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
}

/// What can fail at once must not fail after a minute of simulating: the folder and the device.
void check_before(const SimulationFiles& files, const DemoCommandOptions& options) {
  if (!(options.duration >= 3.0)) {
    throw UsageError("--duration: at least 3 s are needed; the drive begins at rest.");
  }
  check_output_folder(files.recording, options.output);
  open_device(options.device);
  std::error_code error;
  fs::create_directories(options.output, error);
  if (error) {
    throw OutputError(options.output, options.output.string() + ": the folder cannot be made: " +
                                          error.message() + ". Choose another one with -o.");
  }
}

void write_pictures(const fs::path& folder, const Evaluation& evaluation) {
  const CloudFile map = read_ply(RunFiles(folder).map);
  const Trajectory estimate = read_trajectory(RunFiles(folder).tum);
  write_text_file(folder / "map.svg", map_picture(map.sweep.points, estimate.poses));
  write_text_file(folder / "evaluation.svg", plot_evaluation(evaluation, "adit demo"));
}

/// MiB of the files in the folder.
double size_of(const fs::path& folder) {
  uintmax_t bytes = 0;
  std::error_code unknown;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, unknown)) {
    bytes += entry.is_regular_file(unknown) ? entry.file_size(unknown) : 0;
  }
  return static_cast<double>(bytes) / 1048576.0;
}

std::string where_to_look(const SimulationFiles& files, const fs::path& folder) {
  const std::string out = folder.string();
  return "look at  " + out + "/evaluation.html (how the run went, beside the truth)\n         " +
         out + "/map.html (the map, to fly through), " + out + "/map.svg (from above), " + out +
         "/map.ply (any point cloud viewer), " + files.picture.string() + " (the mine)\n" +
         "again    adit run " + files.recording.string() + " -o OUT\n         adit evaluate OUT " +
         files.trajectory.string() + "\n" +
         fmt::format("takes    {:.0f} MiB in {}, most of it the recording {}; it can be removed\n",
                     size_of(folder), out, files.recording.filename().string());
}

std::string verdict(const Evaluation& evaluation, bool good) {
  return fmt::format(
      "error    {:.3f} m (ATE, rmse over {} poses, SE(3)-aligned; {:.3f} m at most), bound {:.2f} "
      "m: {}\n",
      evaluation.ate.rmse, evaluation.ate.count, evaluation.ate.max, kDemoErrorBound,
      good ? "good" : "TOO LARGE");
}

int demo(const DemoCommandOptions& options, std::ostream& out, std::ostream& err) {
  const SimulationFiles files(options.output / "mine.mcap");
  check_before(files, options);
  simulate_mine(files, options, err);
  RunCommandOptions run;
  run.recording = files.recording;
  run.output = options.output;
  run.device = options.device;
  run.quiet = options.quiet;
  const int code = run_command(run, out, err);
  if (code != 0) {
    return code;
  }
  const Trajectory truth = read_trajectory(files.trajectory);
  const RunEvaluation found = evaluate_run(options.output, &truth, {});
  const Evaluation& evaluation = found.truth->evaluation;
  write_pictures(options.output, evaluation);
  write_page(found, options.output / "evaluation.html");
  const bool good = evaluation.ate.rmse <= kDemoErrorBound;
  if (!options.quiet) {
    out << verdict(evaluation, good) << where_to_look(files, options.output) << std::flush;
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

void add_demo_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<DemoCommandOptions>();
  const Command command =
      app.add_command("demo", "Simulate a mine, map it, and compare the result with the truth");
  command.footer(
      "A vehicle with a 64-beam lidar drives through a mine. Nothing is needed but a device; "
      "`adit simulate`\nmakes longer recordings, of other places. The folder takes some 10 MB a "
      "second of the drive.\n\n"
      "Examples:\n"
      "  adit demo\n"
      "  adit demo -o /tmp/demo --device 0\n\n"
      "Exit codes: 0 done, 1 failed or not accurate, 2 usage, 129, 130 or 143 stopped by SIGHUP, "
      "SIGINT\n(Ctrl-C) or SIGTERM.");
  command
      .option("-o,--output", options->output, "Folder for recording and results; made if need be")
      .value_name("OUT")
      .show_default();
  command.option("--duration", options->duration, "Length of the drive (s)")
      .value_name("S")
      .show_default();
  add_device_options(command, options->device);
  command.flag("--quiet", options->quiet, "Print errors alone");
  command.action(
      [options, done = std::move(done)] { done(demo_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
