// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ordered_events.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace adit {
namespace {

/// However far stamps and order disagree, and where a clock stands still.
constexpr uint64_t kMostHeldBytes = uint64_t{256} << 20U;

uint64_t size_of(const Event& event) {
  return event.bytes + sizeof(Event);
}

class OrderedStream final : public EventStream {
 public:
  OrderedStream(std::unique_ptr<EventStream> events, Nanoseconds window)
      : events_(std::move(events)), window_(window) {}

  std::optional<Event> next() override {
    while (!ended_ && !damage_ && !is_due()) {
      read();
    }
    if (held_.empty() && damage_) {
      throw std::move(*std::exchange(damage_, std::nullopt));
    }
    if (held_.empty()) {
      return std::nullopt;
    }
    Event first = std::move(held_.extract(held_.begin()).mapped());
    held_bytes_ -= size_of(first);
    return first;
  }

 private:
  void read() {
    std::optional<Event> event;
    try {
      event = events_->next();
    } catch (const InputError& error) {
      damage_ = error;  // to be told once those before it are out
      return;
    }
    if (!event) {
      ended_ = true;
      return;
    }
    const Nanoseconds stamp = stamp_of(*event);
    latest_ = std::max(latest_, stamp);
    held_bytes_ += size_of(*event);
    held_.emplace(stamp, std::move(*event));  // behind those of the same stamp
  }

  /// True where the first of those held may go.
  bool is_due() const {
    return !held_.empty() &&
           (latest_ - held_.begin()->first >= window_ || held_bytes_ > kMostHeldBytes);
  }

  std::unique_ptr<EventStream> events_;
  Nanoseconds window_;
  Nanoseconds latest_ = Nanoseconds::min() / 2;  // differences of stamps from it do not overflow
  uint64_t held_bytes_ = 0;
  std::multimap<Nanoseconds, Event> held_;
  std::optional<InputError> damage_;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<EventStream> order_by_stamp(std::unique_ptr<EventStream> events,
                                            Nanoseconds window) {
  return std::make_unique<OrderedStream>(std::move(events), window);
}

}  // namespace adit
