// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "adit/tools/publishing/live_status.hpp"

namespace adit {

/// Finds what has changed of sources since they were looked at last: one is silent, one is back, of
/// one messages were lost, or a publisher offers less than adit asks for.
class SourceChanges {
 public:
  using Clock = std::chrono::steady_clock;

  /// A sentence for each change. A source is silent after three seconds; losses are reported every
  /// ten seconds at most.
  std::vector<std::string> look(const std::vector<SourceCounts>& sources, Clock::time_point now);

 private:
  struct Seen {
    uint64_t messages = 0;
    uint64_t lost = 0;            ///< reported
    uint64_t incompatible = 0;    ///< reported
    Clock::time_point arrival{};  ///< the last time that something had arrived
    Clock::time_point loss{};     ///< the last time that a loss was reported
    bool silent = false;          ///< reported
  };
  std::vector<Seen> seen_;
};

/// Prints them as notes, once a second, in a thread of its own.
class SourceWatch {
 public:
  /// `received` is asked from that thread. `quiet`: nothing is printed. `err` outlives it.
  SourceWatch(std::function<std::vector<SourceCounts>()> received, bool quiet, std::ostream& err);

 private:
  std::jthread thread_;
};

}  // namespace adit
