// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>
#include <utility>

namespace adit {

using LiveClock = std::chrono::steady_clock;

inline double seconds_since(LiveClock::time_point start) {
  return std::chrono::duration<double>(LiveClock::now() - start).count();
}

/// From the first packet or message of a lidar on: time in which the other sensors begin, s.
inline constexpr double kFirstLook = 2.0;

/// Between two looks at what has arrived.
inline constexpr auto kLookEvery = std::chrono::milliseconds(20);

/// What is left of a duration (0: no end) after some seconds: at least a millisecond.
inline double rest_of(double duration_s, double passed_s) {
  return duration_s > 0.0 ? std::max(duration_s - passed_s, 1e-3) : 0.0;
}

/// Calls a function once after some seconds, in a thread of its own, unless it goes away before; 0:
/// never.
class LiveTimer {
 public:
  LiveTimer(double seconds, std::function<void()> call) {
    if (seconds > 0.0) {
      thread_ = std::jthread([seconds, call = std::move(call)](const std::stop_token& stop) {
        const auto end = LiveClock::now() + std::chrono::duration<double>(seconds);
        while (!stop.stop_requested()) {
          if (LiveClock::now() >= end) {
            call();
            return;
          }
          std::this_thread::sleep_for(kLookEvery);
        }
      });
    }
  }

 private:
  std::jthread thread_;
};

}  // namespace adit
