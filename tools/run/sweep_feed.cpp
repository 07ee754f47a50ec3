// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/sweep_feed.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "adit/tools/recordings/ordered_events.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kLongestWait = std::chrono::milliseconds(300);

Nanoseconds end_of(const Sweep& sweep) {
  return sweep.stamp +
         std::chrono::round<Nanoseconds>(std::chrono::duration<double>(duration_of(sweep)));
}

std::unique_ptr<EventStream> open_events(const Recording& recording,
                                         const SweepFeedTopics& topics) {
  if (!topics.imu) {
    return recording.events({.topics = {topics.sweeps}, .skip = topics.first});
  }
  return order_by_stamp(recording.events({.topics = {topics.sweeps, *topics.imu}}));
}

}  // namespace

SweepFeed::SweepFeed(const Recording& recording, const SweepFeedTopics& topics,
                     std::function<void(const ImuSample&)> reading)
    : reading_(std::move(reading)),
      skip_(topics.imu ? topics.first : 0),
      waits_(topics.imu.has_value()),
      events_(open_events(recording, topics)) {}

bool SweepFeed::front_is_covered() const {
  if (waiting_.empty()) {
    return false;
  }
  const Nanoseconds end = end_of(std::get<Sweep>(waiting_.front().value));
  return !waits_ || ended_ || newest_reading_ >= end || newest_ > end + kLongestWait;
}

void SweepFeed::take(Event event) {
  newest_ = std::max(newest_, stamp_of(event));
  if (const auto* sample = std::get_if<ImuSample>(&event.value)) {
    newest_reading_ = std::max(newest_reading_, sample->stamp);
    reading_(*sample);
  } else if (skip_ > 0) {
    --skip_;
  } else {
    waiting_.push_back(std::move(event));
  }
}

std::optional<Event> SweepFeed::next() {
  while (!front_is_covered() && !ended_) {
    try {
      std::optional<Event> event = events_->next();
      if (event) {
        take(std::move(*event));
      } else {
        ended_ = true;
      }
    } catch (...) {
      damage_ = std::current_exception();
      ended_ = true;
    }
  }
  if (waiting_.empty()) {
    if (damage_) {
      ended_ = false;  // behind the damage it may go on
      std::rethrow_exception(std::exchange(damage_, nullptr));
    }
    return std::nullopt;
  }
  Event event = std::move(waiting_.front());
  waiting_.pop_front();
  return event;
}

}  // namespace adit
