// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/topic_source.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <ostream>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/containers/live_metadata.hpp"
#include "adit/tools/dds/dds_library.hpp"
#include "adit/tools/live/clock_check.hpp"
#include "adit/tools/live/gpsd_receiver.hpp"
#include "adit/tools/live/growing_messages.hpp"
#include "adit/tools/live/live_folder.hpp"
#include "adit/tools/live/live_outputs.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/message_recorder.hpp"
#include "adit/tools/live/session_recordings.hpp"
#include "adit/tools/live/source_watch.hpp"
#include "adit/tools/live/topic_choice.hpp"
#include "adit/tools/live/topic_receiver.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/run/wanted_run.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Waits for the first sweep, then a while more.
double first_look(const LiveOptions& options, const TopicReceiver& receiver,
                  const std::vector<PublishedTopic>& topics) {
  const auto start = LiveClock::now();
  std::optional<LiveClock::time_point> first;
  while (!first || seconds_since(*first) < kFirstLook) {
    if (const std::string failure = receiver.failure(); !failure.empty()) {
      throw InputError(options.sources.front(), {}, failure, "");
    }
    const std::vector<TopicCounts> counts = receiver.counts();
    for (std::size_t i = 0; i < counts.size() && !first; ++i) {
      if (counts[i].messages > 0 && kind_of(topics[i].topic) == TopicKind::sweeps) {
        first = LiveClock::now();
      }
    }
    if (!first && (seconds_since(start) > options.wait_s || StopSignal::received() != 0)) {
      throw InputError(options.sources.front(), {},
                       fmt::format("no point cloud arrived in {:.1f} s", seconds_since(start)),
                       "Name a topic of point clouds; check that its driver runs, and that both "
                       "sides may use the same network");
    }
    if (first && StopSignal::received() != 0) {
      break;
    }
    std::this_thread::sleep_for(kLookEvery);
  }
  return std::max(seconds_since(*first), 1e-3);
}

/// Bytes that the kernel grants a socket at most; nothing where it does not say.
std::optional<double> most_socket_bytes() {
  std::ifstream file("/proc/sys/net/core/rmem_max");
  double bytes = 0.0;
  return file >> bytes ? std::optional(bytes) : std::nullopt;
}

/// A message comes in parts, which wait in the socket's buffer: it must hold two of the largest.
void say_small_buffer(const std::vector<TopicCounts>& counts, std::ostream& err) {
  double largest = 0.0;
  for (const TopicCounts& one : counts) {
    largest = std::max(largest, static_cast<double>(one.largest));
  }
  const std::optional<double> granted = most_socket_bytes();
  if (granted && *granted < 2.0 * largest) {
    err << fmt::format(
        "note: the socket buffer holds {:.0f} bytes, less than two messages of {:.0f}: some may be "
        "lost. Enlarge it: sysctl -w net.core.rmem_max={:.0f}\n",
        *granted, largest, 4.0 * largest);
  }
}

/// Prints one line per topic: rate, size, and what is wrong with it.
void say_start(const std::vector<PublishedTopic>& topics, const std::vector<TopicCounts>& counts,
               double span_s, std::ostream& err) {
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const TopicCounts& one = counts[i];
    err << fmt::format(
        "{}: {:.1f} messages/s, {:.0f} kB/s{}\n", text_of(topics[i].topic),
        static_cast<double>(one.messages) / span_s, static_cast<double>(one.bytes) / span_s / 1e3,
        one.messages == 0 && !topics[i].topic.latched ? ", nothing has arrived" : "");
    if (topics[i].publishers > 1) {
      err << fmt::format("note: {} nodes publish {}; their messages are mixed\n",
                         topics[i].publishers, topics[i].topic.name);
    }
    if (one.faults.incompatible > 0) {
      err << fmt::format("note: {} of the publishers of {} offer less than adit asks for\n",
                         one.faults.incompatible, topics[i].topic.name);
    }
  }
  say_small_buffer(counts, err);
}

std::unique_ptr<Recording> recording_of(std::unique_ptr<MessageFile> file) {
  std::vector<fs::path> paths = {file->path()};
  std::vector<std::unique_ptr<MessageFile>> files;
  files.push_back(std::move(file));
  return make_message_recording(std::move(paths), std::move(files));
}

/// What has arrived so far, and what arrives.
RunSource source_of(const MessageRecorder& recorder, const Config& config) {
  RunSource source{.known = configured(recording_of(std::make_unique<GrowingMessages>(recorder)),
                                       config.recording)};
  auto growing = std::make_unique<GrowingMessages>(recorder);
  GrowingMessages& file = *growing;
  source.underlying = configured(recording_of(std::move(growing)), config.recording);
  file.wait_for_more();
  source.endless = true;
  source.ends_by_itself = true;
  return source;
}

std::vector<SourceCounts> counts_of(const std::vector<PublishedTopic>& topics,
                                    const TopicReceiver& receiver) {
  std::vector<SourceCounts> counts;
  for (const TopicCounts& one : receiver.counts()) {
    const DdsTopic& topic = topics[counts.size()].topic;
    counts.push_back({.name = topic.name,
                      .messages = one.messages,
                      .bytes = one.bytes,
                      .lost = one.faults.lost,
                      .incompatible = one.faults.incompatible,
                      .steady = kind_of(topic) != TopicKind::transforms});
  }
  return counts;
}

/// What is recorded: the topics, then a gpsd.
struct RecordedChannels {
  std::vector<Channel> channels{};
  std::vector<bool> latched{};
};

RecordedChannels channels_of(const std::vector<PublishedTopic>& topics, bool gpsd, double wait_s) {
  std::string wait;
  append_number(wait, wait_s);
  RecordedChannels recorded;
  for (const PublishedTopic& one : topics) {
    recorded.channels.push_back(channel_of(one.topic));
    recorded.latched.push_back(one.topic.latched);
  }
  if (gpsd) {
    recorded.channels.push_back(gpsd_channel());
    recorded.latched.push_back(false);
  }
  for (Channel& channel : recorded.channels) {
    channel.metadata[kWaitKey] = wait;
  }
  return recorded;
}

/// The session of that number, in a folder of its own.
LiveSession<MessageRecorder> begin_session(const LiveOptions& options, std::size_t number,
                                           const std::vector<Channel>& channels,
                                           std::ostream& err) {
  LiveSession<MessageRecorder> session{.run = options.run};
  session.run.output = session_folder(options.run, number);
  session.run.recording = prepare_recording(session.run, "recording.mcap");
  session.recorder = std::make_unique<MessageRecorder>(session.run.recording, channels);
  leave_room(*session.recorder, options, err);
  return session;
}

std::vector<DdsTopic> topics_of(const std::vector<PublishedTopic>& published) {
  std::vector<DdsTopic> topics;
  for (const PublishedTopic& one : published) {
    topics.push_back(one.topic);
  }
  return topics;
}

}  // namespace

int map_topics(const LiveOptions& options, RunView* view, std::ostream& out, std::ostream& err) {
  const bool quiet = options.run.quiet;
  PendingRecording pending(prepare_recording(options.run, "recording.mcap"), options.run.output);
  const std::unique_ptr<DdsNode> node = open_dds_node(dds_options_of_environment());
  if (!quiet) {
    err << fmt::format("listening; adit waits {} s for topics", options.wait_s) << std::endl;
  }
  const std::vector<PublishedTopic> topics =
      wait_for_topics(*node, options.sources, options.wait_s);
  const std::optional<GpsdEndpoint> gpsd = gpsd_among(options.sources);
  const RecordedChannels recorded =
      channels_of(topics, gpsd.has_value(), load_config(options.run.config).imu.wait);
  MessageSessions sessions(
      [&](std::size_t number) { return begin_session(options, number, recorded.channels, err); },
      [&](const std::string& what) { say_no_session(what, err); }, recorded.latched);
  TopicReceiver receiver(*node, topics_of(topics), sessions);
  LiveOutputs outputs(
      options, node.get(), [&] { return counts_of(topics, receiver); }, err);
  std::optional<GpsdReceiver> fixes;
  if (gpsd) {
    fixes.emplace(*gpsd, fixes_to_messages(sessions, topics.size()));
  }
  const double looked_s = first_look(options, receiver, topics);
  pending.keep();
  if (!quiet) {
    say_start(topics, receiver.counts(), looked_s, err);
    if (fixes) {
      err << fixes->text() << "\n";
    }
    for (const std::string& fault :
         clock_faults(lateness_of(GrowingMessages(*sessions.at(0).recorder)))) {
      err << "note: " << fault << "\n";
    }
  }
  const LiveTimer timer(rest_of(options.duration_s, looked_s), [&] { receiver.stop(); });
  const SourceWatch watch([&] { return counts_of(topics, receiver); }, quiet, err);
  const auto map_one = [&](LiveSession<MessageRecorder>& session, RunView* shown) {
    const OpenSource open = [&](const Config& config) {
      RunSource source = source_of(*session.recorder, config);
      outputs.attach(source, std::nullopt);
      restart_where_wanted(options, source, sessions);
      report_recording(source, *session.recorder);
      return source;
    };
    const int code = run_job(wanted_run(session.run), open, shown, out, err);
    const LiveReport report = outputs.report();
    if (!quiet) {
      err << fmt::format("messages: {} lost on the way\n", report.lost_datagrams);
    }
    return end_live(options, session.run.recording, report, receiver.failure(), code, err);
  };
  return map_sessions(sessions, view, map_one, err);
}

}  // namespace adit
