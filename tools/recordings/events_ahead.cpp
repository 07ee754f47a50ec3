// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/events_ahead.hpp"

#include <chrono>
#include <utility>
#include <variant>

namespace adit {
namespace {

const Sweep* sweep_of(const std::optional<Event>& event) {
  return event ? std::get_if<Sweep>(&event->value) : nullptr;
}

}  // namespace

EventsAhead::EventsAhead(std::unique_ptr<EventStream> events, AheadBounds bounds)
    : events_(std::move(events)),
      bounds_(bounds),
      reader_([this](const std::stop_token& stop) { read_all(stop); }) {}

std::optional<Event> EventsAhead::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return ended_ || !items_.empty(); });
  if (items_.empty()) {
    last_read_ = {};
    return std::nullopt;
  }
  const bool was_full = !has_room();
  Item item = std::move(items_.front());
  count(item, true);
  items_.pop_front();
  const bool makes_room = was_full && has_room();
  lock.unlock();
  if (makes_room) {  // else the reader does not wait
    changed_.notify_one();
  }
  last_read_ = item.span;
  if (item.error) {
    std::rethrow_exception(item.error);
  }
  return std::move(item.event);
}

void EventsAhead::read_all(const std::stop_token& stop) {
  while (true) {
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [this] { return has_room(); })) {
        return;
      }
    }
    if (stop.stop_requested()) {
      return;
    }
    Item item = read_one();
    bool is_waited_for = false;
    {
      const std::scoped_lock lock(mutex_);
      is_waited_for = items_.empty();
      ended_ = item.last;
      if (item.event || item.error) {
        count(item, false);
        items_.push_back(std::move(item));
      }
    }
    if (is_waited_for) {
      changed_.notify_one();
    }
    if (ended_) {
      return;
    }
  }
}

EventsAhead::Item EventsAhead::read_one() {
  Item item;
  item.span.begin = std::chrono::steady_clock::now();
  try {
    item.event = events_->next();
    item.last = !item.event;
  } catch (const InputError&) {
    item.error = std::current_exception();
  } catch (...) {
    item.error = std::current_exception();
    item.last = true;
  }
  item.span.end = std::chrono::steady_clock::now();
  return item;
}

bool EventsAhead::has_room() const {
  return sweeps_ < bounds_.sweeps && bytes_ < bounds_.bytes;
}

void EventsAhead::count(const Item& item, bool taken) {
  const Sweep* sweep = sweep_of(item.event);
  const std::size_t sweeps = sweep != nullptr ? 1 : 0;
  const std::size_t bytes = sizeof(Item) + (sweep != nullptr ? bytes_of(*sweep) : 0);
  sweeps_ = taken ? sweeps_ - sweeps : sweeps_ + sweeps;
  bytes_ = taken ? bytes_ - bytes : bytes_ + bytes;
}

}  // namespace adit
