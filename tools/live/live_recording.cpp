// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/live_recording.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

using Time = ArrivalTimes::Time;
using Clock = std::chrono::system_clock;

constexpr auto kLongestNap = std::chrono::milliseconds(50);

Time arrival(const std::shared_ptr<LivePace>& pace, Nanoseconds received) {
  return pace ? pace->due_of(received)
              : Time(std::chrono::duration_cast<Clock::duration>(received));
}

class LiveStream final : public EventStream {
 public:
  LiveStream(std::unique_ptr<EventStream> events, std::shared_ptr<LivePace> pace,
             ArrivalTimes& arrivals)
      : events_(std::move(events)), pace_(std::move(pace)), arrivals_(&arrivals) {}

  std::optional<Event> next() override {
    if (pace_ && StopSignal::received() != 0) {
      return std::nullopt;
    }
    std::optional<Event> event = events_->next();
    if (!event) {
      return event;
    }
    const Time due = arrival(pace_, event->received);
    while (pace_ && Clock::now() < due) {
      if (StopSignal::received() != 0) {
        return std::nullopt;
      }
      std::this_thread::sleep_for(std::min<Clock::duration>(kLongestNap, due - Clock::now()));
    }
    if (const auto* sweep = std::get_if<Sweep>(&event->value)) {
      arrivals_->add(sweep->stamp, due);
    }
    return event;
  }

 private:
  std::unique_ptr<EventStream> events_;
  std::shared_ptr<LivePace> pace_;
  ArrivalTimes* arrivals_;
};

}  // namespace

Time LivePace::due_of(Nanoseconds received) {
  if (speed_ <= 0.0) {
    return Clock::now();
  }
  const std::scoped_lock lock(mutex_);
  if (!first_) {
    first_ = received;
    start_ = Clock::now();
  }
  const auto since = std::chrono::duration<double, std::nano>(received - *first_) / speed_;
  return start_ + std::chrono::duration_cast<Clock::duration>(since);
}

void ArrivalTimes::add(Nanoseconds stamp, Time arrival) {
  const std::scoped_lock lock(mutex_);
  times_[stamp] = arrival;
}

std::optional<Time> ArrivalTimes::take(Nanoseconds stamp) {
  const std::scoped_lock lock(mutex_);
  const auto found = times_.find(stamp);
  if (found == times_.end()) {
    return std::nullopt;
  }
  const Time arrival = found->second;
  times_.erase(times_.begin(), std::next(found));
  return arrival;
}

std::unique_ptr<EventStream> LiveRecording::events(const EventSelection& selection) const {
  return std::make_unique<LiveStream>(recording_->events(selection), pace_, *arrivals_);
}

Time LiveRecording::arrival_of(Nanoseconds received) const {
  return arrival(pace_, received);
}

}  // namespace adit
