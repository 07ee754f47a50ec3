// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_live.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/live/growing_capture.hpp"
#include "adit/tools/live/live_recording.hpp"
#include "adit/tools/live/packet_recorder.hpp"
#include "adit/tools/live/udp_receiver.hpp"
#include "adit/tools/recordings/capture_recording.hpp"
#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// From the first packet on: time for a first look at the sensors.
constexpr double kFirstLook = 2.0;  // s

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// From the arrival of sweeps to their poses.
class Latency {
 public:
  explicit Latency(ArrivalTimes& arrivals) : arrivals_(&arrivals) {}

  void add(Nanoseconds stamp) {
    if (const auto arrival = arrivals_->take(stamp)) {
      ms_.push_back(
          std::chrono::duration<float, std::milli>(std::chrono::system_clock::now() - *arrival)
              .count());
    }
  }

  LiveReport report() const {
    LiveReport report{.sweeps = ms_.size()};
    if (!ms_.empty()) {
      std::vector<float> sorted = ms_;
      std::ranges::sort(sorted);
      const auto at = [&](double share) {
        const auto rank =
            static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
        return static_cast<double>(sorted[std::max<std::size_t>(rank, 1) - 1]);
      };
      report.latency_p50_ms = at(0.5);
      report.latency_p99_ms = at(0.99);
    }
    return report;
  }

 private:
  ArrivalTimes* arrivals_;
  std::vector<float> ms_;
};

void say_latency(const LiveReport& report, std::ostream& err) {
  err << fmt::format("latency: median {:.0f} ms, 99 % {:.0f} ms, of {} sweeps\n",
                     report.latency_p50_ms, report.latency_p99_ms, report.sweeps);
}

int map_paced(const LiveCommandOptions& options, std::ostream& out, std::ostream& err) {
  RunCommandOptions given = options.run;
  given.recording = options.sources.front();
  const WantedRun chosen = wanted_run(given);
  ArrivalTimes arrivals;
  Latency latency(arrivals);
  const OpenSource open = [&](const Config& config) {
    RunSource source{.known = open_recording(chosen.options.recording, config.recording)};
    source.arriving = std::make_unique<LiveRecording>(*source.known, options.speed, arrivals);
    source.ends_by_itself = true;
    source.placed = [&](const Sweep& sweep) { latency.add(sweep.stamp); };
    source.report = [&] { return latency.report(); };
    return source;
  };
  const int code = run_job(chosen, open, nullptr, out, err);
  if (!given.quiet) {
    say_latency(latency.report(), err);
  }
  return code;
}

/// Waits for packets; then a while more. Throws InputError where none come.
double first_look(const LiveCommandOptions& options, const UdpReceiver& receiver) {
  const auto start = Clock::now();
  std::optional<Clock::time_point> first;
  while (!first || seconds_since(*first) < kFirstLook) {
    if (const std::string failure = receiver.failure(); !failure.empty()) {
      throw InputError(options.sources.front(), {}, failure, "");
    }
    uint64_t datagrams = 0;
    uint64_t unknown = 0;
    for (const UdpCounts& counts : receiver.counts()) {
      datagrams += counts.datagrams;
      unknown += counts.unknown;
    }
    if (!first && datagrams > 0) {
      first = Clock::now();
    }
    if (StopSignal::received() != 0 && first) {
      break;
    }
    if (!first && (seconds_since(start) > options.wait_s || StopSignal::received() != 0)) {
      throw InputError(
          options.sources.front(), {},
          fmt::format("no packet of a known sensor arrived in {:.1f} s ({} others did)",
                      seconds_since(start), unknown),
          "Check the address and port that the sensor sends to, and a firewall; an Ouster needs "
          "--metadata FILE");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return std::max(seconds_since(*first), 1e-3);
}

void say_start(const LiveCommandOptions& options, const UdpReceiver& receiver, double span_s,
               std::ostream& err) {
  const std::vector<UdpCounts> all = receiver.counts();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const UdpCounts& one = all[i];
    const double rate = static_cast<double>(one.bytes) / span_s;
    err << fmt::format("{}: {:.0f} packets/s, {:.0f} kB/s{}\n", options.sources[i],
                       static_cast<double>(one.datagrams) / span_s, rate / 1e3,
                       one.sender.empty() ? ", nothing has arrived" : " from " + one.sender);
    if (rate > static_cast<double>(one.buffer)) {
      err << fmt::format(
          "note: the socket buffer holds {} bytes, less than a second of that. Enlarge it: "
          "sysctl -w net.core.rmem_max={:.0f}\n",
          one.buffer, std::ceil(2.0 * rate));
    }
  }
}

LiveReport with_counts(LiveReport report, const UdpReceiver& receiver) {
  for (const UdpCounts& counts : receiver.counts()) {
    report.lost_datagrams += counts.lost;
    report.unknown_datagrams += counts.unknown + counts.other_senders;
  }
  return report;
}

/// The file that packets go to. An Ouster's metadata go beside it, where `adit run` looks for them.
fs::path prepare_recording(const RunCommandOptions& run) {
  const fs::path file = run.output / "recording.pcap";
  const fs::path metadata = run.output / "recording.json";
  check_output_folder(file, run.output);
  if (!run.overwrite) {
    require_no_results(run.output);
  }
  std::error_code error;
  if (fs::exists(file, error) && !run.overwrite) {
    throw UsageError(file.string() +
                     ": there is a recording already. Name another folder with -o, "
                     "or replace it with --overwrite.");
  }
  fs::create_directories(run.output, error);
  fs::remove(file, error);
  fs::remove(metadata, error);
  const std::optional<fs::path> named = run.config.metadata;
  if (named && named->extension() == ".json") {
    fs::copy_file(*named, metadata, error);
  }
  return file;
}

int map_received(const LiveCommandOptions& options, const std::vector<UdpEndpoint>& endpoints,
                 std::ostream& out, std::ostream& err) {
  RunCommandOptions given = options.run;
  if (given.output.empty()) {
    given.output = "live";
  }
  std::optional<OusterSensor> ouster;
  if (given.config.metadata && fs::path(*given.config.metadata).extension() == ".json") {
    ouster = read_ouster_sensor(*given.config.metadata);
  }
  given.recording = prepare_recording(given);
  PacketRecorder recorder(given.recording);
  UdpReceiver receiver(endpoints, recorder, ouster);
  if (!given.quiet) {
    err << fmt::format("listening; adit waits {} s for the first packet", options.wait_s)
        << std::endl;
  }
  const double looked_s = first_look(options, receiver);
  if (!given.quiet) {
    say_start(options, receiver, looked_s, err);
  }
  const std::jthread timer([&](const std::stop_token& stop) {
    const auto start = Clock::now();
    while (options.duration_s > 0.0 && !stop.stop_requested()) {
      if (seconds_since(start) + looked_s >= options.duration_s) {
        receiver.stop();
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  ArrivalTimes arrivals;
  Latency latency(arrivals);
  const WantedRun chosen = wanted_run(given);
  const OpenSource open = [&](const Config& config) {
    RunSource source{.known = open_recording(chosen.options.recording, config.recording)};
    source.underlying = configured(
        std::make_unique<GrowingCapture>(
            recorder,
            sensor_of_capture(chosen.options.recording, config.recording.metadata.value_or("")),
            source.known->topics()),
        config.recording);
    source.arriving = std::make_unique<LiveRecording>(*source.underlying, std::nullopt, arrivals);
    source.endless = true;
    source.ends_by_itself = true;
    source.placed = [&](const Sweep& sweep) { latency.add(sweep.stamp); };
    source.report = [&] { return with_counts(latency.report(), receiver); };
    return source;
  };
  const int code = run_job(chosen, open, nullptr, out, err);
  const LiveReport report = with_counts(latency.report(), receiver);
  if (!given.quiet) {
    say_latency(report, err);
    err << fmt::format("datagrams: {} lost in the kernel's buffer, {} left out as of no sensor\n",
                       report.lost_datagrams, report.unknown_datagrams);
  }
  std::error_code ignored;
  if (!options.record) {
    fs::remove(given.recording, ignored);
  }
  if (const std::string failure = receiver.failure(); !failure.empty()) {
    err << "adit live: receiving ended early: " << failure << "\n";
    return 1;
  }
  return code;
}

int live(const LiveCommandOptions& options, std::ostream& out, std::ostream& err) {
  if (options.sources.empty()) {
    throw UsageError("SOURCE is missing: name udp://ADDRESS:PORT or a recording.");
  }
  if (!(options.wait_s > 0.0 && options.speed >= 0.0 && options.duration_s >= 0.0)) {
    throw UsageError("--wait must be above 0, --speed and --duration not below.");
  }
  const StopSignal stop;
  std::vector<UdpEndpoint> endpoints;
  for (const std::string& source : options.sources) {
    if (const auto endpoint = udp_endpoint(source)) {
      endpoints.push_back(*endpoint);
    }
  }
  if (!endpoints.empty() && endpoints.size() < options.sources.size()) {
    throw UsageError("Name recordings or udp:// sources, not both.");
  }
  if (endpoints.empty() && options.sources.size() > 1) {
    throw UsageError("Name one recording.");
  }
  return endpoints.empty() ? map_paced(options, out, err)
                           : map_received(options, endpoints, out, err);
}

}  // namespace

int live_command(const LiveCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit live", out, err, [&] { return live(options, out, err); });
}

void add_live_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<LiveCommandOptions>();
  const Command command = app.add_command("live", "Map what sensors send, as it arrives");
  command.footer(
      "SOURCE is udp://ADDRESS:PORT, where a sensor's packets arrive (Velodyne, Hesai, Livox; "
      "Ouster with\n--metadata); several are of one sensor. Or it is a recording, which is played "
      "at "
      "its own pace.\n"
      "OUT gets what `adit run` writes, and recording.pcap, of which `adit run` makes the same "
      "map.\n\n"
      "Examples:\n"
      "  adit live udp://127.0.0.1:2368 -o out\n"
      "  adit live udp://0.0.0.0:7502 udp://0.0.0.0:7503 --metadata os1.json -o out\n"
      "  adit live drive.mcap --speed 2 -o out\n\n"
      "Exit codes: 0 done, also after Ctrl-C or SIGTERM; 1 failed, or nothing arrived; 2 usage.");
  command.option("source", options->sources, "Where sensors send to, or a recording")
      .value_name("SOURCE");
  command.option("-o,--output", options->run.output, "Folder for the results; without it ./live")
      .value_name("OUT");
  command.flag("--odometry", options->run.odometry, "Odometry alone: no map, no loops, no GNSS");
  command.flag("--overwrite", options->run.overwrite,
               "Replace the results of an earlier run in OUT, its recording included");
  add_config_options(command, options->run.config);
  add_metadata_option(command, options->run.config);
  add_device_options(command, options->run.device);
  command.option("--wait", options->wait_s, "Wait so long for the first packets, then exit 1")
      .value_name("S");
  command.option("--duration", options->duration_s, "Receive for so long; 0: until Ctrl-C")
      .value_name("S");
  command.option("--speed", options->speed, "Pace of a recording; 0: as fast as it is mapped")
      .value_name("N");
  command.flag(
      "--no-record", [options] { options->record = false; },
      "Remove OUT/recording.pcap at the end");
  command.flag("--json", options->run.json, "Print summary.json instead of the table");
  command.flag("--quiet", options->run.quiet, "Print errors alone");
  command.action(
      [options, done = std::move(done)] { done(live_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
