// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/packet_source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>
#include <system_error>
#include <thread>

#include <fmt/core.h>

#include "adit/tools/live/growing_capture.hpp"
#include "adit/tools/live/live_folder.hpp"
#include "adit/tools/live/live_latency.hpp"
#include "adit/tools/live/live_recording.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/packet_recorder.hpp"
#include "adit/tools/recordings/capture_recording.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/run/wanted_run.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Waits for packets; then a while more. Throws InputError where none come.
double first_look(const LiveOptions& options, const UdpReceiver& receiver) {
  const auto start = LiveClock::now();
  std::optional<LiveClock::time_point> first;
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
      first = LiveClock::now();
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
    std::this_thread::sleep_for(kLookEvery);
  }
  return std::max(seconds_since(*first), 1e-3);
}

void say_start(const LiveOptions& options, const UdpReceiver& receiver, double span_s,
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

/// An Ouster's metadata go beside the recording, where `adit run` looks for them.
void copy_metadata(const RunCommandOptions& run) {
  fs::path beside = run.recording;
  beside.replace_extension(".json");
  std::error_code error;
  fs::remove(beside, error);
  const std::optional<fs::path> named = run.config.metadata;
  if (named && named->extension() == ".json") {
    fs::copy_file(*named, beside, error);
  }
}

}  // namespace

int map_packets(const LiveOptions& options, const std::vector<UdpEndpoint>& endpoints,
                RunView* view, std::ostream& out, std::ostream& err) {
  RunCommandOptions given = options.run;
  std::optional<OusterSensor> ouster;
  if (given.config.metadata && fs::path(*given.config.metadata).extension() == ".json") {
    ouster = read_ouster_sensor(*given.config.metadata);
  }
  given.recording = prepare_recording(given, "recording.pcap");
  copy_metadata(given);
  PendingRecording pending(given.recording, given.output);
  PacketRecorder recorder(given.recording);
  UdpReceiver receiver(endpoints, recorder, ouster);
  if (!given.quiet) {
    err << fmt::format("listening; adit waits {} s for the first packet", options.wait_s)
        << std::endl;
  }
  const double looked_s = first_look(options, receiver);
  pending.keep();
  if (!given.quiet) {
    say_start(options, receiver, looked_s, err);
  }
  const LiveTimer timer(rest_of(options.duration_s, looked_s), [&] { receiver.stop(); });
  ArrivalTimes arrivals;
  LiveLatency latency(arrivals);
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
    source.placed = [&](const Sweep& sweep, const SweepResult&) { latency.add(sweep.stamp); };
    source.report = [&] { return with_counts(latency.report(), receiver); };
    return source;
  };
  const int code = run_job(chosen, open, view, out, err);
  const LiveReport report = with_counts(latency.report(), receiver);
  if (!given.quiet) {
    err << fmt::format("datagrams: {} lost in the kernel's buffer, {} left out as of no sensor\n",
                       report.lost_datagrams, report.unknown_datagrams);
  }
  return end_live(options, given.recording, report, receiver.failure(), code, err);
}

}  // namespace adit
