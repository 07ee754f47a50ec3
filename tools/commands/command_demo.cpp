// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_demo.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/evaluation/evaluation_plot.hpp"
#include "adit/tools/evaluation/run_evaluation.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// Fast enough that a minute of it is round the first pillar and on along the first drift.
constexpr double kSpeed = 2.4;  // m/s

/// Round the first pillar of rock, with a lidar of 16 beams.
void simulate_mine(const SimulationFiles& files, const DemoCommandOptions& options,
                   std::ostream& err) {
  SimulationOptions simulation;
  simulation.scene = "mine";
  simulation.lidars.front().sensor = "VLP-16";
  simulation.speed = kSpeed;
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
  std::error_code error;
  if (!fs::exists(files.recording, error)) {  // an earlier demo may go, another run may not
    require_no_results(options.output);
  }
  open_device(options.device);
  fs::create_directories(options.output, error);
  if (error) {
    throw OutputError(options.output, options.output.string() + ": the folder cannot be made: " +
                                          error.message() + ". Choose another one with -o.");
  }
}

void draw_map(const fs::path& folder, std::ostream& err) {
  ExportCommandOptions picture;
  picture.map = RunFiles(folder).database;
  picture.output = folder / "map.svg";
  picture.picture = true;
  std::ostringstream said;
  if (export_command(picture, said, err) != 0) {
    throw OutputError(*picture.output, picture.output->string() + ": see above.");
  }
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
         "loops    adit loops " + RunFiles(folder).database.string() + "\n" +
         "again    adit run --from " + RunFiles(folder).database.string() +
         " -o OUT\n         adit evaluate OUT " + files.trajectory.string() + "\n" +
         fmt::format("takes    {:.0f} MiB in {}, most of it the recording {}; it can be removed\n",
                     size_of(folder), out, files.recording.filename().string());
}

std::string verdict(const Evaluation& odometry, const Evaluation& map, std::size_t loops,
                    bool good) {
  const std::string found =
      loops == 0 ? "no place was seen twice; a longer --duration comes round\n"
                 : fmt::format(
                       "the odometry drifted by up to {:.3f} m, {:.3f} m rmse; {} loops "
                       "took it back\n",
                       odometry.ate.max, odometry.ate.rmse, loops);
  return "drift    " + found +
         fmt::format(
             "error    {:.3f} m (ATE, rmse over {} poses, SE(3)-aligned; {:.3f} m at most), bound "
             "{:.2f} m: {}\n",
             map.ate.rmse, map.ate.count, map.ate.max, kDemoErrorBound,
             good ? "good" : "TOO LARGE");
}

std::size_t closed_loops(const fs::path& folder) {
  const PoseGraph graph = MapDatabase(RunFiles(folder).database, MapAccess::read).graph();
  return static_cast<std::size_t>(std::ranges::count_if(graph.edges(), [](const PoseEdge& edge) {
    return edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active;
  }));
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
  run.overwrite = true;  // check_before() has found nothing but an earlier demo
  const int code = run_command(run, out, err);
  if (code != 0) {
    return code;
  }
  const Trajectory truth = read_trajectory(files.trajectory);
  const Evaluation odometry =
      evaluate(read_trajectory(RunFiles(options.output).odometry), truth, {});
  const RunEvaluation found = evaluate_run(options.output, &truth, {});
  const Evaluation& map = found.truth->evaluation;
  draw_map(options.output, err);
  write_text_file(options.output / "evaluation.svg", plot_evaluation(map, "adit demo"));
  write_page(found, options.output / "evaluation.html");
  const bool good = map.ate.rmse <= kDemoErrorBound;
  if (!options.quiet) {
    out << verdict(odometry, map, closed_loops(options.output), good)
        << where_to_look(files, options.output) << std::flush;
  }
  if (!good) {
    err << "adit demo: the error " << map.ate.rmse << " m is above " << kDemoErrorBound << " m"
        << std::endl;
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
      "A vehicle with a 16-beam lidar drives round a pillar of rock and closes the loop. Nothing "
      "is "
      "needed but a\ndevice; `adit simulate` makes longer recordings, of other places. The folder "
      "takes some 5 MB a second\nof the drive.\n\n"
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
