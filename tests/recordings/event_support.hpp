// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

namespace adit::test {

/// The sweep with this index on the recording's first topic.
inline Sweep read_sweep(const Recording& recording, std::size_t index) {
  return std::get<Sweep>(recording.events({.topics = {0}, .skip = index})->next().value().value);
}

/// A recording as far as it can be read.
struct ReadEvents {
  std::vector<Event> events;
  std::vector<InputError> errors;
};

inline ReadEvents read_all(const Recording& recording, const EventSelection& selection = {}) {
  ReadEvents read;
  const auto stream = recording.events(selection);
  for (bool more = true; more;) {
    try {
      auto event = stream->next();
      more = event.has_value();
      if (event) {
        read.events.push_back(std::move(*event));
      }
    } catch (const InputError& error) {
      read.errors.push_back(error);
    }
  }
  return read;
}

/// Events in memory, in their order.
class GivenRecording final : public Recording {
 public:
  GivenRecording(std::vector<Topic> topics, std::vector<Event> events)
      : topics_(std::move(topics)), events_(std::move(events)) {}

  const std::vector<Topic>& topics() const override { return topics_; }
  std::string description() const override { return "made for a test"; }
  bool times_are_assumed() const override { return false; }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<Stream>(events_, selection);
  }

 private:
  class Stream final : public EventStream {
   public:
    Stream(const std::vector<Event>& events, EventSelection selection)
        : events_(&events), selection_(std::move(selection)) {}
    std::optional<Event> next() override {
      while (index_ < events_->size()) {
        const Event& event = (*events_)[index_++];
        const bool wanted =
            selection_.topics.empty() || std::ranges::count(selection_.topics, event.topic) > 0;
        if (wanted && event.received >= selection_.begin && event.received <= selection_.end) {
          return event;
        }
      }
      return std::nullopt;
    }

   private:
    const std::vector<Event>* events_;
    EventSelection selection_;
    std::size_t index_ = 0;
  };

  std::vector<Topic> topics_;
  std::vector<Event> events_;
};

/// A sweep of one return, or of none; received with its stamp.
inline Event sweep_event(std::size_t topic, int ms, const std::string& frame, bool empty = false) {
  Sweep sweep;
  sweep.stamp = std::chrono::milliseconds(ms);
  if (!empty) {
    sweep.points = {{1.0F, 2.0F, 3.0F, 0.0F}};
  }
  return {.topic = topic,
          .received = sweep.stamp,
          .value = std::move(sweep),
          .bytes = 16,
          .frame = frame};
}

/// A reading of a sensor that turns, times `factor`.
inline Event reading_event(std::size_t topic, int ms, const std::string& frame,
                           double factor = 1.0) {
  const Nanoseconds stamp = std::chrono::milliseconds(ms);
  return {.topic = topic,
          .received = stamp,
          .value = ImuSample{.stamp = stamp,
                             .angular_velocity = factor * Eigen::Vector3d(0.1, 0.0, 0.2),
                             .linear_acceleration = factor * Eigen::Vector3d(0.0, 0.1, 9.8)},
          .bytes = 300,
          .frame = frame};
}

}  // namespace adit::test
