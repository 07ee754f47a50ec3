// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/record_job.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <ostream>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/dds/dds_library.hpp"
#include "adit/tools/live/gpsd_receiver.hpp"
#include "adit/tools/live/live_folder.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/message_recorder.hpp"
#include "adit/tools/live/packet_recorder.hpp"
#include "adit/tools/live/topic_choice.hpp"
#include "adit/tools/live/topic_receiver.hpp"
#include "adit/tools/live/udp_receiver.hpp"
#include "adit/tools/packets/ouster_sensor.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr double kReportEvery = 10.0;  // s

/// What has been recorded.
struct Progress {
  uint64_t messages = 0;
  uint64_t bytes = 0;
  uint64_t lost = 0;
};

Progress progress_of(const UdpReceiver& receiver) {
  Progress sum;
  for (const UdpCounts& one : receiver.counts()) {
    sum.messages += one.datagrams;
    sum.bytes += one.bytes;
    sum.lost += one.lost;
  }
  return sum;
}

Progress progress_of(const TopicReceiver& receiver) {
  Progress sum;
  for (const TopicCounts& one : receiver.counts()) {
    sum.messages += one.messages;
    sum.bytes += one.bytes;
    sum.lost += one.faults.lost;
  }
  return sum;
}

void say(const Progress& progress, double seconds, std::ostream& err) {
  err << fmt::format("{:.0f} s: {} messages, {:.1f} MB ({:.2f} MB/s), {} lost\n", seconds,
                     progress.messages, static_cast<double>(progress.bytes) / 1e6,
                     static_cast<double>(progress.bytes) / 1e6 / std::max(seconds, 1e-3),
                     progress.lost)
      << std::flush;
}

/// Until a signal, the end of the duration or of the receiver. Returns the exit code.
template <class Receiver>
int watch(const RecordOptions& options, Receiver& receiver, PendingRecording& pending,
          std::ostream& err) {
  const auto start = LiveClock::now();
  double said = 0.0;
  while (StopSignal::received() == 0 && receiver.failure().empty()) {
    const double passed = seconds_since(start);
    const Progress progress = progress_of(receiver);
    if (progress.messages == 0 && passed > options.wait_s) {
      throw InputError(options.sources.front(), {},
                       fmt::format("nothing arrived in {:.1f} s", passed),
                       "Check that the sensor sends to this address, or that its driver runs");
    }
    if (!options.quiet && passed - said >= kReportEvery) {
      say(progress, passed, err);
      said = passed;
    }
    if (options.duration_s > 0.0 && passed >= options.duration_s) {
      break;
    }
    std::this_thread::sleep_for(kLookEvery);
  }
  receiver.stop();
  receiver.wait();
  const Progress progress = progress_of(receiver);
  if (progress.messages > 0) {
    pending.keep();
  }
  if (!options.quiet) {
    say(progress, seconds_since(start), err);
  }
  if (const std::string failure = receiver.failure(); !failure.empty()) {
    err << "adit record: recording ended early: " << failure << "\n";
    return 1;
  }
  return 0;
}

int record_topics(const RecordOptions& options, const RecordingSplit& split, std::ostream& err) {
  const std::unique_ptr<DdsNode> node = open_dds_node(dds_options_of_environment());
  std::vector<DdsTopic> topics;
  std::vector<Channel> channels;
  for (const PublishedTopic& one : wait_for_topics(*node, options.sources, options.wait_s)) {
    if (!options.quiet) {
      err << text_of(one.topic) << "\n";
    }
    topics.push_back(one.topic);
    channels.push_back(channel_of(one.topic));
  }
  const std::optional<GpsdEndpoint> gpsd = gpsd_among(options.sources);
  if (gpsd) {
    channels.push_back(gpsd_channel());
  }
  PendingRecording pending(RecordingParts(options.output, split).path());
  MessageRecorder recorder(options.output, std::move(channels), split);
  TopicReceiver receiver(*node, topics, recorder);
  std::optional<GpsdReceiver> fixes;
  if (gpsd) {
    fixes.emplace(*gpsd, fixes_to_messages(recorder, topics.size()));
  }
  return watch(options, receiver, pending, err);
}

int record_packets(const RecordOptions& options, const std::vector<UdpEndpoint>& endpoints,
                   const RecordingSplit& split, std::ostream& err) {
  std::optional<OusterSensor> ouster;
  if (options.metadata) {
    ouster = read_ouster_sensor(*options.metadata);
  }
  PendingRecording pending(RecordingParts(options.output, split).path());
  PacketRecorder recorder(options.output, split);
  std::optional<GpsdReceiver> fixes;
  if (const std::optional<GpsdEndpoint> gpsd = gpsd_among(options.sources)) {
    begin_gpsd(recorder);
    fixes.emplace(*gpsd, fixes_to_packets(recorder));
  }
  UdpReceiver receiver(endpoints, recorder, std::move(ouster));
  return watch(options, receiver, pending, err);
}

/// Throws UsageError where a file of the recording is there and is not to be replaced.
void require_free_output(const RecordOptions& options, const RecordingSplit& split) {
  const fs::path first = RecordingParts(options.output, split).path();
  std::error_code unknown;
  if (!fs::exists(first, unknown)) {
    return;
  }
  if (!options.overwrite) {
    throw UsageError(first.string() +
                     " is there already, and is not replaced. Name another one, or give "
                     "--overwrite.");
  }
  fs::remove(first, unknown);
}

}  // namespace

int record(const RecordOptions& options, std::ostream& err) {
  std::vector<UdpEndpoint> endpoints;
  for (const std::string& source : options.sources) {
    if (const auto endpoint = udp_endpoint(source)) {
      endpoints.push_back(*endpoint);
    } else if (!is_topic_source(source)) {
      throw UsageError(source +
                       ": is no source: udp://ADDRESS:PORT, ros2, the name of a topic or "
                       "gpsd://HOST.");
    }
  }
  const bool packets = !endpoints.empty();
  const std::size_t receivers = gpsd_among(options.sources) ? 1 : 0;
  if (options.sources.empty() ||
      (packets && endpoints.size() + receivers < options.sources.size())) {
    throw UsageError("Name udp:// sources or ROS 2 topics, with one gpsd:// at most.");
  }
  const std::string extension = packets ? ".pcap" : ".mcap";
  if (options.output.extension() != extension) {
    throw UsageError("-o " + options.output.string() + ": must end in " + extension +
                     ", which is what is written.");
  }
  const StopSignal stop;
  const RecordingSplit split{.duration = nanoseconds(options.split_s),
                             .bytes = options.split_bytes};
  require_free_output(options, split);
  return packets ? record_packets(options, endpoints, split, err)
                 : record_topics(options, split, err);
}

}  // namespace adit
