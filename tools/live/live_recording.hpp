// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// When sweeps arrived, by their stamps. Threads may share it.
class ArrivalTimes {
 public:
  using Time = std::chrono::system_clock::time_point;

  void add(Nanoseconds stamp, Time arrival);
  /// Forgets the sweep and those before it; nothing where it is not known.
  std::optional<Time> take(Nanoseconds stamp);

 private:
  std::mutex mutex_;
  std::map<Nanoseconds, Time> times_;
};

/// When events of a recording are due that is played at some times its own pace, counted from the
/// first that was asked for; 0: at once. Threads may share it.
class LivePace {
 public:
  explicit LivePace(double speed) : speed_(speed) {}
  ArrivalTimes::Time due_of(Nanoseconds received);

 private:
  double speed_;
  std::mutex mutex_;
  std::optional<Nanoseconds> first_;
  ArrivalTimes::Time start_;
};

/// A recording whose events come no earlier than they are due, and whose sweeps' arrival is noted.
///
/// With a speed, an event is due when it was received, counted from the first, at that many times
/// the pace of the recording; 0: at once. A signal (StopSignal) ends the streams. Without a speed
/// events come as the recording gives them, and arrival is when they were received (since 1970).
class LiveRecording final : public Recording {
 public:
  /// `recording` and `arrivals` outlive it.
  LiveRecording(const Recording& recording, std::optional<double> speed, ArrivalTimes& arrivals)
      : recording_(&recording), arrivals_(&arrivals) {
    if (speed) {
      pace_ = std::make_shared<LivePace>(*speed);
    }
  }

  const std::vector<Topic>& topics() const override { return recording_->topics(); }
  std::string description() const override { return recording_->description(); }
  bool times_are_assumed() const override { return recording_->times_are_assumed(); }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override;

  /// Of an event that was given.
  ArrivalTimes::Time arrival_of(Nanoseconds received) const;

 private:
  const Recording* recording_;
  std::shared_ptr<LivePace> pace_;  ///< null: events come as they are
  ArrivalTimes* arrivals_;
};

}  // namespace adit
