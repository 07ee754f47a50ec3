// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/topic_source.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
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
#include "adit/tools/live/live_latency.hpp"
#include "adit/tools/live/live_recording.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/message_recorder.hpp"
#include "adit/tools/live/topic_choice.hpp"
#include "adit/tools/live/topic_publisher.hpp"
#include "adit/tools/live/topic_receiver.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/run/wanted_run.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/setup/static_transforms.hpp"
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

/// The frame of the first sweep.
std::string lidar_frame_of(const Recording& recording) {
  EventSelection selection;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (recording.topics()[i].kind == TopicKind::sweeps) {
      selection.topics.push_back(i);
    }
  }
  const auto events = recording.events(selection);
  try {
    const std::optional<Event> first = events->next();
    return first ? first->frame : "";
  } catch (const InputError&) {
    return "";  // reported where it is mapped
  }
}

LiveReport with_counts(LiveReport report, const TopicReceiver& receiver) {
  for (const TopicCounts& counts : receiver.counts()) {
    report.lost_datagrams += counts.faults.lost;
  }
  return report;
}

}  // namespace

int list_topics(double wait_s, std::ostream& out) {
  const std::unique_ptr<DdsNode> node = open_dds_node(dds_options_of_environment());
  const auto start = LiveClock::now();
  while (seconds_since(start) < wait_s && StopSignal::received() == 0) {
    std::this_thread::sleep_for(kLookEvery);
  }
  std::string sweeps;
  for (const PublishedTopic& one : understood_topics(*node)) {
    const TopicKind kind = kind_of(one.topic);
    out << fmt::format("{:10} {}\n", to_string(kind), text_of(one.topic));
    sweeps = sweeps.empty() && kind == TopicKind::sweeps ? one.topic.name : sweeps;
  }
  out << (sweeps.empty() ? "no topic of point clouds is published\n"
                         : "map it: adit live ros2 -o out\n")
      << std::flush;
  return sweeps.empty() ? 1 : 0;
}

int map_topics(const LiveOptions& options, RunView* view, std::ostream& out, std::ostream& err) {
  RunCommandOptions given = options.run;
  given.recording = prepare_recording(given, "recording.mcap");
  PendingRecording pending(given.recording, given.output);
  const std::unique_ptr<DdsNode> node = open_dds_node(dds_options_of_environment());
  if (!given.quiet) {
    err << fmt::format("listening; adit waits {} s for topics", options.wait_s) << std::endl;
  }
  const std::vector<PublishedTopic> topics =
      wait_for_topics(*node, options.sources, options.wait_s);
  std::string wait;
  append_number(wait, load_config(given.config).imu.wait);
  std::vector<DdsTopic> wanted;
  std::vector<Channel> channels;
  for (const PublishedTopic& one : topics) {
    wanted.push_back(one.topic);
    channels.push_back(channel_of(one.topic));
    channels.back().metadata[kWaitKey] = wait;
  }
  const std::optional<GpsdEndpoint> gpsd = gpsd_among(options.sources);
  if (gpsd) {
    channels.push_back(gpsd_channel());
    channels.back().metadata[kWaitKey] = wait;
  }
  MessageRecorder recorder(given.recording, std::move(channels));
  TopicReceiver receiver(*node, wanted, recorder);
  std::optional<GpsdReceiver> fixes;
  if (gpsd) {
    fixes.emplace(*gpsd, recorder, wanted.size());
  }
  const double looked_s = first_look(options, receiver, topics);
  pending.keep();
  if (!given.quiet) {
    say_start(topics, receiver.counts(), looked_s, err);
    if (fixes) {
      err << fmt::format("gpsd://{}:{}: {}, {} fixes\n", gpsd->host, gpsd->port,
                         fixes->connected() ? "connected" : "not connected", fixes->fixes());
    }
    for (const std::string& fault : clock_faults(lateness_of(GrowingMessages(recorder)))) {
      err << "note: " << fault << "\n";
    }
  }
  const LiveTimer timer(rest_of(options.duration_s, looked_s), [&] { receiver.stop(); });
  std::optional<TopicPublisher> publisher;
  if (options.publishes) {
    publisher.emplace(*node, options.frames);
  }
  ArrivalTimes arrivals;
  LiveLatency latency(arrivals);
  const WantedRun chosen = wanted_run(given);
  const OpenSource open = [&](const Config& config) {
    RunSource source = source_of(recorder, config);
    source.arriving = std::make_unique<LiveRecording>(*source.underlying, std::nullopt, arrivals);
    if (publisher) {
      publisher->mount(frame_tree_of(recorded_transforms(*source.known, {})),
                       lidar_frame_of(*source.known));
      source.mapped = [&](const SweepPlaced& placed) { publisher->publish(placed); };
    }
    source.placed = [&](const Sweep& sweep, const SweepResult& result) {
      latency.add(sweep.stamp);
      if (publisher) {
        publisher->publish(sweep, result);
      }
    };
    source.report = [&] { return with_counts(latency.report(), receiver); };
    return source;
  };
  const int code = run_job(chosen, open, view, out, err);
  const LiveReport report = with_counts(latency.report(), receiver);
  if (!given.quiet) {
    err << fmt::format("messages: {} lost on the way\n", report.lost_datagrams);
  }
  return end_live(options, given.recording, report, receiver.failure(), code, err);
}

}  // namespace adit
