// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_live.hpp"

#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <unistd.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/json_log.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/live/gpsd_receiver.hpp"
#include "adit/tools/live/paced_source.hpp"
#include "adit/tools/live/packet_source.hpp"
#include "adit/tools/live/source_list.hpp"
#include "adit/tools/live/topic_choice.hpp"
#include "adit/tools/live/topic_source.hpp"
#include "adit/tools/live/udp_receiver.hpp"
#include "adit/tools/run/run_view.hpp"
#include "adit/tools/support/color.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr const char* kFolder = "live";
constexpr double kLongestLook = 5.0;  // s, at what arrives
// A network delivers in order but for some milliseconds. The first of the settings, so that others
// win.
constexpr const char* kShortWait = "imu.wait=0.02";

using MapSource = std::function<int(const LiveOptions&, RunView*)>;

/// How the sources are mapped, which are of one kind; a gpsd may be beside them.
MapSource source_of(const std::vector<std::string>& sources, std::ostream& out, std::ostream& err) {
  std::vector<UdpEndpoint> endpoints;
  for (const std::string& source : sources) {
    if (const auto endpoint = udp_endpoint(source)) {
      endpoints.push_back(*endpoint);
    }
  }
  const std::size_t receivers = gpsd_among(sources) ? 1 : 0;
  const auto topics = static_cast<std::size_t>(std::ranges::count_if(sources, is_topic_source));
  if (!endpoints.empty() && endpoints.size() + receivers == sources.size()) {
    return [endpoints, &out, &err](const LiveOptions& options, RunView* view) {
      return map_packets(options, endpoints, view, out, err);
    };
  }
  if (topics > 0 && topics == sources.size()) {
    return [&](const LiveOptions& options, RunView* view) {
      return map_topics(options, view, out, err);
    };
  }
  if (sources.size() != 1) {
    throw UsageError("Name udp:// sources, ROS 2 topics or one recording, not several kinds.");
  }
  return
      [&](const LiveOptions& options, RunView* view) { return map_paced(options, view, out, err); };
}

int live(LiveOptions options, std::ostream& out, std::ostream& err) {
  if (!(options.wait_s > 0.0 && options.speed >= 0.0 && options.duration_s >= 0.0)) {
    throw UsageError("--wait must be above 0, --speed and --duration not below.");
  }
  // A recording has an end of its own: it is one session.
  const bool is_recording = std::ranges::none_of(options.sources, [](const std::string& source) {
    return is_topic_source(source) || udp_endpoint(source).has_value();
  });
  // On a terminal a hang-up is its end, and so that of the run.
  const StopSignal stop(is_recording || surroundings_of(STDERR_FILENO).terminal);
  if (options.lists || options.sources.empty()) {
    return list_sources(std::min(options.wait_s, kLongestLook), out);
  }
  if (options.run.output.empty()) {
    options.run.output = kFolder;
  }
  std::vector<std::string>& settings = options.run.config.overrides;
  settings.insert(settings.begin(), kShortWait);
  const MapSource map = source_of(options.sources, out, err);
  std::optional<RunView> view;
  if (options.run.view) {
    view.emplace(options.run.serve, options.sources.front(), err);
  }
  const int code = map(options, view ? &*view : nullptr);
  if (view) {
    view->serve_result(options.run.output, options.run.quiet);
  }
  return code;
}

}  // namespace

int live_command(const LiveOptions& options, std::ostream& out, std::ostream& err) {
  if (options.log_json) {
    JsonLog log(err);
    std::ostream lines(&log);
    return guarded("adit live", out, lines, [&] { return live(options, out, lines); });
  }
  return guarded("adit live", out, err, [&] { return live(options, out, err); });
}

void add_live_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<LiveOptions>();
  const Command command = app.add_command("live", "Map what sensors send, as it arrives");
  command.footer(
      "SOURCE is udp://ADDRESS:PORT, where a sensor's packets arrive (Velodyne, Hesai, Livox; "
      "Ouster with\n--metadata), several of one sensor; `ros2` for all ROS 2 topics that adit "
      "reads, or their names; or a\nrecording, which is played at its own pace. `gpsd://HOST` adds "
      "the fixes of a GNSS receiver\nto packets or topics.\n"
      "OUT gets what `adit run` writes, and recording.pcap or recording.mcap, of which `adit run` "
      "makes the same\nmap. SIGHUP ends the session and begins the next one, in OUT-2, while the "
      "sensors go on; on a\nterminal it ends the run. Without SOURCE, what arrives is listed.\n\n"
      "Examples:\n"
      "  adit live udp://127.0.0.1:2368 -o out\n"
      "  adit live udp://0.0.0.0:7502 udp://0.0.0.0:7503 --metadata os1.json -o out\n"
      "  adit live ros2 -o out\n"
      "  adit live /points /imu gpsd://localhost -o out\n"
      "  adit live udp://0.0.0.0:2368 gpsd://localhost -o out\n"
      "  adit live drive.mcap --speed 2 -o out\n"
      "  adit live ros2 --map site -o out        localise in an earlier map\n\n"
      "Exit codes: 0 done, also after Ctrl-C or SIGTERM; 1 failed, or nothing arrived; 2 usage.");
  command.option("source", options->sources, "Where sensors send to, topics, or a recording")
      .value_name("SOURCE");
  command.option("-o,--output", options->run.output, "Folder for the results; without it ./live")
      .value_name("OUT");
  command.flag("--odometry", options->run.odometry, "Odometry alone: no map, no loops, no GNSS");
  command.option("--topic", options->run.topic, "The topic of the sweeps, where there are several")
      .value_name("NAME");
  command
      .option("--merge", options->run.merged_topics,
              "A topic of another range sensor, whose sweeps are merged with those of --topic; may "
              "be repeated")
      .value_name("NAME");
  command.flag("--overwrite", options->run.overwrite,
               "Replace the results of an earlier run in OUT, its recording included");
  command.flag("--publish", options->publishes,
               "Publish odometry, transforms, the map and diagnostics to ROS 2");
  command.option("--map-frame", options->frames.map, "With --publish: the frame of the map")
      .value_name("NAME")
      .show_default();
  command.option("--odom-frame", options->frames.odom, "With --publish: the frame of the odometry")
      .value_name("NAME")
      .show_default();
  command
      .option("--base-frame", options->frames.base,
              "With --publish: the frame that moves; without it the lidar's")
      .value_name("NAME");
  command.flag("--list", options->lists,
               "List the topics and packets that can be mapped, and end; so without a SOURCE");
  command
      .option("--status-port", options->status_port,
              "Answer /health and /metrics (Prometheus) on 127.0.0.1; 0: any port that is free")
      .value_name("PORT");
  command.flag("--log-json", options->log_json, "Print notes and errors as lines of JSON");
  command.flag("--restart", options->restarts,
               "After a failure of the device, go on in a next session");
  add_config_options(command, options->run.config);
  add_metadata_option(command, options->run.config);
  add_device_options(command, options->run.device);
  add_map_use_options(command, options->run.earlier_map);
  command
      .option("--wait", options->wait_s,
              "Wait so long for the first packets or messages, then exit 1")
      .value_name("S");
  command.option("--duration", options->duration_s, "Receive for so long; 0: until Ctrl-C")
      .value_name("S");
  command.option("--speed", options->speed, "Pace of a recording; 0: as fast as it is mapped")
      .value_name("N");
  command.flag(
      "--no-record", [options] { options->record = false; },
      "Keep no recording: what arrives is on the disk until it is mapped");
  command.flag("--view", options->run.view, "Show the run in a browser as it goes on");
  add_serve_options(command, options->run.serve, "With --view: ");
  command.flag("--json", options->run.json, "Print summary.json instead of the table");
  command.flag("--quiet", options->run.quiet, "Print errors alone");
  command.action(
      [options, done = std::move(done)] { done(live_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
