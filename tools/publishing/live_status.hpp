// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/executor/slam.hpp"
#include "adit/tools/publishing/duration_sample.hpp"

namespace adit {

/// What has arrived of a source.
struct SourceCounts {
  std::string name;
  uint64_t messages = 0;  ///< or packets
  uint64_t bytes = 0;
  uint64_t lost = 0;      ///< sent, and not received
  uint64_t left_out = 0;  ///< of no known sensor or of a second sender: neither used nor recorded
  uint64_t incompatible = 0;  ///< publishers whose quality of service does not fit
  bool steady = true;         ///< it is expected to go on; static transforms are not
};

/// The state of a live run, for machines that watch it. Threads may share it.
class LiveStatus {
 public:
  using Clock = std::chrono::steady_clock;

  /// `received`: asked from any thread.
  explicit LiveStatus(std::function<std::vector<SourceCounts>()> received)
      : received_(std::move(received)) {}

  /// The next session begins, counted from 1.
  void begin_session();
  /// The odometry has placed a sweep, so long after its last point arrived.
  void add(const SweepResult& result, std::optional<double> latency_ms);
  /// The map has a sweep.
  void add(const SweepPlaced& placed);

  /// Sweeps that wait for the map.
  std::size_t map_behind() const;
  /// "starting" before the first sweep of a session, "no data" where none was placed for three
  /// seconds, "not aligned" where the last one was not, else "ok".
  std::string health(Clock::time_point now = Clock::now()) const;
  /// The same with figures, JSON.
  std::string health_json(Clock::time_point now = Clock::now()) const;
  /// Prometheus' text format, version 0.0.4.
  std::string metrics(Clock::time_point now = Clock::now()) const;

 private:
  std::string health_of(Clock::time_point now) const;
  std::size_t waiting() const { return sweeps_ - std::min(mapped_, sweeps_); }

  std::function<std::vector<SourceCounts>()> received_;
  mutable std::mutex mutex_;
  std::size_t session_ = 0;
  std::size_t sweeps_ = 0;
  std::size_t unaligned_ = 0;
  std::size_t mapped_ = 0;
  std::size_t keyframes_ = 0;
  DurationSample latency_;
  std::optional<Clock::time_point> last_{};  ///< sweep of the session
  OdometryState state_ = OdometryState::initializing;
};

}  // namespace adit
