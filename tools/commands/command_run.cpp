// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_run.hpp"

#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/run/run_judgement.hpp"
#include "adit/tools/run/run_view.hpp"
#include "adit/tools/run/wanted_run.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

OpenSource opened_recording(const WantedRun& chosen) {
  return [all = recordings_of(chosen.options)](const Config& config) {
    return RunSource{.known = open_recording(all, config.recording)};
  };
}

int run(const RunCommandOptions& given, std::ostream& out, std::ostream& err) {
  const StopSignal stop;  // from the start: opening a recording or a device takes a while
  const WantedRun chosen = wanted_run(given);
  std::optional<RunView> view;
  if (given.view) {
    view.emplace(given.serve, chosen.options.recording, err);
  }
  const bool complete = chosen.continued && chosen.continued->progress.complete;
  const int code =
      complete ? tell_of_complete_run(*chosen.continued, chosen.options, out, err)
               : run_job(chosen, opened_recording(chosen), view ? &*view : nullptr, out, err);
  if (view) {
    view->serve_result(chosen.options.output, given.quiet);
  }
  return code;
}

}  // namespace

int run_command(const RunCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit run", out, err, [&] { return run(options, out, err); });
}

void add_run_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<RunCommandOptions>();
  const Command command = app.add_command("run", "Map a recording: trajectory, map and summary");
  command.footer(
      "RECORDING is an MCAP file, a ROS 1 bag, a rosbag2 folder or .db3 file, a capture of packets "
      "(pcap, pcapng);\nor a folder: "
      "sweeps as KITTI has them (velodyne/*.bin with times.txt), *.pcd, *.ply, *.las or *.laz, TUM "
      "RGB-D;\n"
      "or one such file.\n"
      "The run makes a map, closes loops and uses GNSS fixes; --odometry runs odometry alone.\n"
      "OUT gets map.adit (the map database), trajectory.tum, trajectory.kitti, odometry.tum, "
      "online.tum,\n"
      "sweeps.csv, map.ply, map.html and summary.json; with --high-rate also "
      "odometry_highrate.tum and .csv.\n"
      "`adit evaluate OUT` draws them, `adit view OUT` shows them. A folder holds one run: adit "
      "replaces an\n"
      "earlier one only with --overwrite. Other files stay.\n\n"
      "Examples:\n"
      "  adit run drive.mcap                  the results go to ./drive\n"
      "  adit run drive/ -o out\n"
      "  adit run drive.mcap --topic /points -o out --odometry\n"
      "  adit run drive_0.bag drive_1.bag -o out\n"
      "  adit run drive/ -o out --map-resolution 0.1 --set preprocess.r_input=0.5\n"
      "  adit run drive/ -o out --device 1 --max-vram 2GiB --profile\n"
      "  adit run drive/ -o out --view\n"
      "  adit run -o out --continue\n"
      "  adit run --from out/map.adit -o finer --set mapping.r_submap=0.1\n"
      "  adit run later.mcap --map out -o there           localise the recording in a map\n"
      "  adit run later.mcap --map out --extend -o both   extend a copy of the map\n\n"
      "Exit codes: 0 done, 1 failed on the data or the device, 2 usage, 129, 130 or 143 stopped\n"
      "by SIGHUP, SIGINT (Ctrl-C) or SIGTERM: what was computed by then is kept.\n"
      "The environment's ADIT_DEVICE stands in for --device.");
  auto recordings = std::make_shared<std::vector<std::filesystem::path>>();
  command.option("recording", *recordings, "Files or folder to map").value_name("RECORDING");
  command
      .option("-o,--output", options->output,
              "Folder for the results, made if need be; without it ./NAME, the recording's name")
      .value_name("OUT");
  command.flag("--odometry", options->odometry,
               "Odometry alone: no map, no loops, no GNSS (mapping.enabled=false)");
  command.flag("--overwrite", options->overwrite,
               "Replace the results of an earlier run in OUT, its map included");
  add_config_options(command, options->config);
  add_metadata_option(command, options->config);
  add_device_options(command, options->device);
  add_max_ram_option(command, options->max_ram_bytes);
  command.flag("--profile", options->stage_table, "Print a table of the time of every stage");
  command
      .option("--timeline", options->timeline,
              "Draw what worked when: reader, host, device, map, writing (.html; .json for "
              "Perfetto)")
      .value_name("FILE");
  command
      .option("--map-resolution", options->map.resolution,
              "Keep one map point per voxel of this size (m)")
      .value_name("M");
  command.flag(
      "--no-map", [options] { options->map.enabled = false; }, "Write no map.ply");
  command.flag("--high-rate", options->high_rate.enabled,
               "Write odometry_highrate.tum and .csv: the pose at every IMU reading");
  command
      .option("--high-rate-smoothing", options->high_rate.smoothing,
              "Spread the corrections that sweeps bring over this time; 0: steps")
      .value_name("S");
  command
      .option("--topic", options->topic, "The topic of the sweeps, where the recording has several")
      .value_name("NAME");
  command
      .option("--merge", options->merged_topics,
              "A topic of another range sensor, whose sweeps are merged with those of --topic; may "
              "be repeated")
      .value_name("NAME");
  command.option("--start", options->start, "First sweep, counted from 0").value_name("N");
  command.option("--count", options->count, "Sweeps at most").value_name("N");
  command.flag("--continue", options->continues,
               "Go on with OUT/map.adit where a run was stopped or killed: its recording, settings "
               "and sweeps");
  command
      .option("--from", options->from,
              "Map the recording of this map again, with its settings where no others are given")
      .value_name("MAP");
  add_map_use_options(command, options->earlier_map);
  command.flag("--strict", options->strict,
               "Exit 1 unless the run's verdict is reliable; the results are written all the "
               "same");
  command.flag("--strict-input", options->strict_input,
               "End at the first damaged message; else such are left out and counted");
  command.flag("--view", options->view,
               "Show the run in a browser while it goes on, and its result until Ctrl-C");
  add_serve_options(command, options->serve, "With --view: ");
  command.flag("--json", options->json, "Print summary.json instead of the table");
  command.flag("--quiet", options->quiet, "Print errors alone");
  command.action([options, recordings, done = std::move(done)] {
    take_recordings(*options, *recordings);
    done(run_command(*options, std::cout, std::cerr));
  });
}

}  // namespace adit
