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

#include "adit/tools/live/gpsd_receiver.hpp"
#include "adit/tools/live/growing_capture.hpp"
#include "adit/tools/live/live_folder.hpp"
#include "adit/tools/live/live_outputs.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/packet_recorder.hpp"
#include "adit/tools/live/session_recordings.hpp"
#include "adit/tools/live/source_watch.hpp"
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

void say_start(const std::vector<UdpEndpoint>& endpoints, const UdpReceiver& receiver,
               double span_s, std::ostream& err) {
  const std::vector<UdpCounts> all = receiver.counts();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const UdpCounts& one = all[i];
    const double rate = static_cast<double>(one.bytes) / span_s;
    err << fmt::format("{}: {:.0f} packets/s, {:.0f} kB/s{}\n", text_of(endpoints[i]),
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

std::vector<SourceCounts> counts_of(const std::vector<UdpEndpoint>& endpoints,
                                    const UdpReceiver& receiver) {
  std::vector<SourceCounts> counts;
  for (const UdpCounts& one : receiver.counts()) {
    counts.push_back({.name = text_of(endpoints[counts.size()]),
                      .messages = one.datagrams,
                      .bytes = one.bytes,
                      .lost = one.lost,
                      .left_out = one.unknown + one.other_senders});
  }
  return counts;
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

/// The session of that number, in a folder of its own.
LiveSession<PacketRecorder> begin_session(const LiveOptions& options, std::size_t number, bool gpsd,
                                          std::ostream& err) {
  LiveSession<PacketRecorder> session{.run = options.run};
  session.run.output = session_folder(options.run, number);
  session.run.recording = prepare_recording(session.run, "recording.pcap");
  copy_metadata(session.run);
  session.recorder = std::make_unique<PacketRecorder>(session.run.recording);
  leave_room(*session.recorder, options, err);
  if (gpsd) {
    begin_gpsd(*session.recorder);
  }
  return session;
}

/// What has arrived so far, and what arrives.
RunSource source_of(const PacketRecorder& recorder, const RunCommandOptions& run,
                    const Config& config) {
  RunSource source{.known = open_recording(run.recording, config.recording)};
  source.underlying = configured(
      std::make_unique<GrowingCapture>(
          recorder, sensor_of_capture(run.recording, config.recording.metadata.value_or("")),
          source.known->topics()),
      config.recording);
  source.endless = true;
  source.ends_by_itself = true;
  return source;
}

}  // namespace

int map_packets(const LiveOptions& options, const std::vector<UdpEndpoint>& endpoints,
                RunView* view, std::ostream& out, std::ostream& err) {
  std::optional<OusterSensor> ouster;
  const std::optional<fs::path> metadata = options.run.config.metadata;
  if (metadata && metadata->extension() == ".json") {
    ouster = read_ouster_sensor(*metadata);
  }
  const std::optional<GpsdEndpoint> gpsd = gpsd_among(options.sources);
  PacketSessions sessions(
      [&](std::size_t number) { return begin_session(options, number, gpsd.has_value(), err); },
      [&](const std::string& what) { say_no_session(what, err); });
  PendingRecording pending(sessions.at(0).run.recording, options.run.output);
  UdpReceiver receiver(endpoints, sessions, ouster);
  LiveOutputs outputs(
      options, nullptr, [&] { return counts_of(endpoints, receiver); }, err);
  std::optional<GpsdReceiver> fixes;
  if (gpsd) {
    fixes.emplace(*gpsd, fixes_to_packets(sessions));
  }
  if (!options.run.quiet) {
    err << fmt::format("listening; adit waits {} s for the first packet", options.wait_s)
        << std::endl;
  }
  const double looked_s = first_look(options, receiver);
  pending.keep();
  if (!options.run.quiet) {
    say_start(endpoints, receiver, looked_s, err);
    if (fixes) {
      err << fixes->text() << "\n";
    }
  }
  const LiveTimer timer(rest_of(options.duration_s, looked_s), [&] { receiver.stop(); });
  const SourceWatch watch([&] { return counts_of(endpoints, receiver); }, options.run.quiet, err);
  const auto map_one = [&](LiveSession<PacketRecorder>& session, RunView* shown) {
    const OpenSource open = [&](const Config& config) {
      RunSource source = source_of(*session.recorder, session.run, config);
      outputs.attach(source, std::nullopt);
      restart_where_wanted(options, source, sessions);
      report_recording(source, *session.recorder);
      return source;
    };
    const int code = run_job(wanted_run(session.run), open, shown, out, err);
    const LiveReport report = outputs.report();
    if (!options.run.quiet) {
      err << fmt::format("datagrams: {} lost in the kernel's buffer, {} left out as of no sensor\n",
                         report.lost_datagrams, report.unknown_datagrams);
    }
    return end_live(options, session.run.recording, report, receiver.failure(), code, err);
  };
  return map_sessions(sessions, view, map_one, err);
}

}  // namespace adit
