// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/steady_stamps.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include <fmt/core.h>

namespace adit {
namespace {

// More than queues and networks delay, less than clocks that are set wrong differ.
constexpr Nanoseconds kLeap = std::chrono::seconds(10);
constexpr std::size_t kAgree = 3;

bool is_measured(const EventValue& value) {
  return !std::holds_alternative<ReferencePose>(value) &&
         !std::holds_alternative<StaticTransform>(value);
}

/// Stamps may be anything: no overflow.
double seconds_between(Nanoseconds a, Nanoseconds b) {
  return (static_cast<double>(b.count()) - static_cast<double>(a.count())) * 1e-9;
}

class SteadyStream final : public EventStream {
 public:
  SteadyStream(std::unique_ptr<EventStream> events, const std::vector<Topic>& topics,
               std::filesystem::path file)
      : events_(std::move(events)), topics_(&topics), file_(std::move(file)) {}

  std::optional<Event> next() override {
    while (true) {
      if (!leapt_.empty()) {
        const Event event = std::move(leapt_.front());
        leapt_.pop_front();
        report(event);
      }
      if (!ready_.empty()) {
        Event event = std::move(ready_.front());
        ready_.pop_front();
        return event;
      }
      std::optional<Event> event = events_->next();
      if (!event) {
        drop_all();
        if (leapt_.empty()) {
          return std::nullopt;
        }
        continue;
      }
      if (!is_measured(event->value)) {
        return event;
      }
      take(std::move(*event));
    }
  }

 private:
  /// Of a topic.
  struct Clock {
    std::optional<double> late{};  ///< s from stamp to receipt, of the last that passed
    std::deque<Event> held{};      ///< leap, all alike
    double held_late = 0.0;        ///< of the last one
  };

  void take(Event event) {
    Clock& clock = clocks_[event.topic];
    const double late = seconds_between(stamp_of(event), event.received);
    const double leap = std::chrono::duration<double>(kLeap).count();
    if (!clock.late || std::abs(late - *clock.late) <= leap) {
      drop(clock);
      clock.late = late;
      ready_.push_back(std::move(event));
      return;
    }
    if (!clock.held.empty() && std::abs(late - clock.held_late) > leap) {
      drop(clock);
    }
    clock.held.push_back(std::move(event));
    clock.held_late = late;
    if (clock.held.size() >= kAgree) {
      clock.late = late;
      std::ranges::move(clock.held, std::back_inserter(ready_));
      clock.held.clear();
    }
  }

  void drop(Clock& clock) {
    std::ranges::move(clock.held, std::back_inserter(leapt_));
    clock.held.clear();
  }

  void drop_all() {
    for (auto& [topic, clock] : clocks_) {
      drop(clock);
    }
  }

  [[noreturn]] void report(const Event& event) const {
    const std::string& name = (*topics_)[event.topic].name;
    const std::string place = event.number ? fmt::format("message {} of {}", *event.number, name)
                                           : "a message of " + name;
    throw InputError(
        file_, Place::named(place),
        fmt::format("its stamp lies {:.3f} s before its receipt, unlike those around it",
                    seconds_between(stamp_of(event), event.received)),
        "It is left out; look for what corrupts messages on their way");
  }

  std::unique_ptr<EventStream> events_;
  const std::vector<Topic>* topics_;
  std::filesystem::path file_;
  std::map<std::size_t, Clock> clocks_;
  std::deque<Event> ready_;
  std::deque<Event> leapt_;
};

}  // namespace

std::unique_ptr<EventStream> with_steady_stamps(std::unique_ptr<EventStream> events,
                                                const std::vector<Topic>& topics,
                                                std::filesystem::path file) {
  return std::make_unique<SteadyStream>(std::move(events), topics, std::move(file));
}

}  // namespace adit
