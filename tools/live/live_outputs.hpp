// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <vector>

#include "adit/tools/live/live_latency.hpp"
#include "adit/tools/live/live_options.hpp"
#include "adit/tools/live/live_recording.hpp"
#include "adit/tools/publishing/live_status.hpp"
#include "adit/tools/publishing/map_publisher.hpp"
#include "adit/tools/publishing/motion_publisher.hpp"
#include "adit/tools/publishing/status_server.hpp"
#include "adit/tools/publishing/topic_publisher.hpp"
#include "adit/tools/run/run_job.hpp"

namespace adit {

/// What a live run gives while it goes on, besides the files of its folder: its latency, ROS 2
/// topics (--publish), /health and /metrics (--status-port).
class LiveOutputs {
 public:
  /// `node`: what to publish by; null: one is opened where something is published. It and `err`
  /// outlive this. `received`: asked from any thread. Throws std::runtime_error and UsageError.
  LiveOutputs(const LiveOptions& options, DdsNode* node,
              std::function<std::vector<SourceCounts>()> received, std::ostream& err);
  ~LiveOutputs();
  LiveOutputs(const LiveOutputs&) = delete;
  LiveOutputs& operator=(const LiveOutputs&) = delete;

  /// A session begins with this source, of which `known` and `underlying`, if there is one, are
  /// set: what arrives is read at that speed (LiveRecording). Throws InputError where --base-frame
  /// cannot be placed.
  void attach(RunSource& source, std::optional<double> speed);

  /// Of the session; what was lost or left out is of all.
  LiveReport report() const;

 private:
  struct Session;
  void begin(const BegunRun& run);
  void place(const Sweep& sweep, const SweepResult& result);
  void take(const SweepPlaced& placed);
  void end();

  std::function<std::vector<SourceCounts>()> received_;
  std::ostream& err_;
  bool quiet_;
  std::unique_ptr<DdsNode> own_node_;
  std::optional<TopicPublisher> topics_;
  std::optional<MapPublisher> map_;
  std::optional<MotionPublisher> motion_;
  LiveStatus status_;
  std::unique_ptr<Session> session_;
  std::optional<StatusServer> server_;  ///< last: it asks the status
};

}  // namespace adit
