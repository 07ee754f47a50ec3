// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/live_outputs.hpp"

#include <limits>
#include <ostream>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/dds/dds_library.hpp"
#include "adit/tools/setup/static_transforms.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/resident_memory.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr std::size_t kReportedLag = 100;  // sweeps that the map is behind; then twice as many
// An hour's optimisations leave a third of the heap unused in pieces. Giving it back takes some ms.
constexpr std::size_t kSweepsBetweenReleases = 600;
constexpr const char* kPaths = "/health and /metrics are answered here.\n";

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

StatusAnswer answer_to(const std::string& path, const LiveStatus& status) {
  if (path == "/metrics") {
    return {.type = "text/plain; version=0.0.4; charset=utf-8", .body = status.metrics()};
  }
  if (path == "/health") {
    const std::string health = status.health();
    return {.code = health == "ok" || health == "starting" ? 200U : 503U,
            .type = "application/json",
            .body = status.health_json()};
  }
  return {.code = 404, .type = "text/plain", .body = kPaths};
}

}  // namespace

struct LiveOutputs::Session {
  ArrivalTimes arrivals{};
  LiveLatency latency{arrivals};
  const LiveRecording* arriving = nullptr;
  std::size_t lag_to_report = kReportedLag;  ///< sweeps
  std::size_t mapped = 0;                    ///< the same
};

LiveOutputs::LiveOutputs(const LiveOptions& options, DdsNode* node,
                         std::function<std::vector<SourceCounts>()> received, std::ostream& err)
    : received_(received), err_(err), quiet_(options.run.quiet), status_(std::move(received)) {
  if (options.publishes) {
    if (node == nullptr) {
      own_node_ = open_dds_node(dds_options_of_environment());
      node = own_node_.get();
    }
    topics_.emplace(*node, options.frames);
    map_.emplace(*node, options.frames.map);
    motion_.emplace(*node);
  }
  if (options.status_port) {
    if (*options.status_port > std::numeric_limits<uint16_t>::max()) {
      throw UsageError("--status-port: must be at most 65535.");
    }
    server_.emplace(static_cast<uint16_t>(*options.status_port),
                    [this](const std::string& path) { return answer_to(path, status_); });
    if (!options.run.quiet) {
      err << fmt::format("status: http://127.0.0.1:{}/health and /metrics\n", server_->port())
          << std::flush;
    }
  }
}

LiveOutputs::~LiveOutputs() = default;

void LiveOutputs::attach(RunSource& source, std::optional<double> speed) {
  session_ = std::make_unique<Session>();
  status_.begin_session();
  const Recording& read = source.underlying ? *source.underlying : *source.known;
  auto arriving = std::make_unique<LiveRecording>(read, speed, session_->arrivals);
  session_->arriving = arriving.get();
  source.arriving = std::move(arriving);
  if (topics_) {
    topics_->begin(frame_tree_of(recorded_transforms(*source.known, {})),
                   lidar_frame_of(*source.known));
  }
  source.begun = [this](const BegunRun& run) { begin(run); };
  source.placed = [this](const Sweep& sweep, const SweepResult& result) { place(sweep, result); };
  source.mapped = [this](const SweepPlaced& placed) { take(placed); };
  source.ended = [this](const MappingResult&) { end(); };
  source.report = [this] { return report(); };
}

void LiveOutputs::begin(const BegunRun& run) {
  if (!topics_) {
    return;
  }
  if (run.map) {
    map_->begin(*run.map, topics_->T_lidar_base());
  }
  if (run.imu) {
    motion_->begin(
        {.recording = &run.mapped,
         .topic = *run.imu,
         .config = run.config.imu,
         .arrival =
             [this](Nanoseconds received) { return session_->arriving->arrival_of(received); },
         .odom_frame = topics_->frames().odom,
         .base_frame = topics_->frames().base,
         .T_lidar_base = topics_->T_lidar_base()});
  }
}

void LiveOutputs::place(const Sweep& sweep, const SweepResult& result) {
  status_.add(result, session_->latency.add(sweep.stamp));
  if (const std::size_t lag = status_.map_behind(); lag >= session_->lag_to_report && !quiet_) {
    err_ << fmt::format("note: the map is {} sweeps behind the odometry, which does not wait\n",
                        lag)
         << std::flush;
    session_->lag_to_report = 2 * lag;
  }
  if (topics_) {
    topics_->publish(sweep, result);
    motion_->update(result.inertial);
  }
}

void LiveOutputs::take(const SweepPlaced& placed) {
  status_.add(placed);
  if (++session_->mapped % kSweepsBetweenReleases == 0) {
    release_free_memory();
  }
  if (topics_) {
    topics_->publish(placed);
  }
}

void LiveOutputs::end() {
  if (topics_) {
    map_->end();
    motion_->end();
  }
}

LiveReport LiveOutputs::report() const {
  LiveReport report = session_ ? session_->latency.report() : LiveReport{};
  for (const SourceCounts& one : received_()) {
    report.lost_datagrams += one.lost;
    report.unknown_datagrams += one.left_out;
  }
  if (motion_) {
    const DurationSample ages = motion_->ages();
    report.high_rate_age_p50_ms = ages.quantile_ms(0.5);
    report.high_rate_age_p99_ms = ages.quantile_ms(0.99);
    report.high_rate_poses = ages.count();
  }
  return report;
}

}  // namespace adit
