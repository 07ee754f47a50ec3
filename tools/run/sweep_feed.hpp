// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <optional>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// What a SweepFeed reads.
struct SweepFeedTopics {
  std::size_t sweeps = 0;
  std::optional<std::size_t> imu{};
  std::size_t first = 0;  ///< sweeps before this one are passed over
};

/// The sweeps of a recording, each once the readings that cover it have been handed on.
///
/// With an IMU events come in the order of their stamps, and a sweep waits for a reading at its
/// end: for 0.3 s of the recording at most, since the IMU may have stopped. Damage in the recording
/// is thrown once the sweeps before it are out.
class SweepFeed {
 public:
  SweepFeed(const Recording& recording, const SweepFeedTopics& topics,
            std::function<void(const ImuSample&)> reading);

  /// The next sweep, nothing at the end. Throws InputError as EventStream::next() does.
  std::optional<Event> next();

 private:
  bool front_is_covered() const;
  void take(Event event);

  std::function<void(const ImuSample&)> reading_;
  std::size_t skip_;
  bool waits_;
  std::unique_ptr<EventStream> events_;
  std::deque<Event> waiting_;
  Nanoseconds newest_reading_ = Nanoseconds::min();
  Nanoseconds newest_ = Nanoseconds::min();
  bool ended_ = false;
  std::exception_ptr damage_;
};

}  // namespace adit
