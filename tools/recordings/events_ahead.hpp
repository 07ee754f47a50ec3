// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A stream of events that is read ahead of who takes them, so that decoding and what comes of it
// overlap.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/support/clock_span.hpp"

namespace adit {

/// How far a stream is read ahead. Another event is begun where both are undercut, so that one too
/// many bytes is one event's.
struct AheadBounds {
  std::size_t sweeps = 2;                      ///< waiting to be taken, the one being read included
  std::size_t bytes = std::size_t{16} << 20U;  ///< of all events that wait to be taken
};

/// Gives what another stream gives, in the same order and errors at the same place, but reads it
/// in a thread of its own. The destructor waits for the event that is being read, no longer.
class EventsAhead final : public EventStream {
 public:
  /// Begins to read. What `events` reads from must allow that from another thread.
  explicit EventsAhead(std::unique_ptr<EventStream> events, AheadBounds bounds = {});

  /// Waits for the reader, if need be.
  std::optional<Event> next() override;

  /// When the reader was busy with what next() gave or threw last.
  const ClockSpan& last_read() const { return last_read_; }

 private:
  struct Item {
    std::optional<Event> event{};
    std::exception_ptr error{};  ///< instead of the event
    ClockSpan span{};
    bool last = false;  ///< nothing follows, not even behind the error
  };

  void read_all(const std::stop_token& stop);
  Item read_one();
  bool has_room() const;
  void count(const Item& item, bool taken);

  std::unique_ptr<EventStream> events_;  ///< the reader's alone
  const AheadBounds bounds_;
  ClockSpan last_read_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Item> items_;
  std::size_t sweeps_ = 0;  ///< in `items_`
  std::size_t bytes_ = 0;   ///< likewise
  bool ended_ = false;      ///< nothing follows what is in `items_`
  std::jthread reader_;     ///< last, so that it ends first
};

}  // namespace adit
