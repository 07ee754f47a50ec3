// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/source_watch.hpp"

#include <ostream>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

constexpr auto kSilence = std::chrono::seconds(3);
constexpr auto kBetweenLosses = std::chrono::seconds(10);
constexpr auto kBetweenLooks = std::chrono::seconds(1);

}  // namespace

std::vector<std::string> SourceChanges::look(const std::vector<SourceCounts>& sources,
                                             Clock::time_point now) {
  std::vector<std::string> changes;
  if (seen_.empty()) {
    for (const SourceCounts& one : sources) {
      seen_.push_back({.messages = one.messages,
                       .lost = 0,
                       .incompatible = one.incompatible,
                       .arrival = now,
                       .loss = now - kBetweenLosses,
                       .silent = false});
    }
  }
  for (std::size_t i = 0; i < sources.size() && i < seen_.size(); ++i) {
    const SourceCounts& now_there = sources[i];
    Seen& seen = seen_[i];
    const double silence = std::chrono::duration<double>(now - seen.arrival).count();
    if (now_there.messages != seen.messages) {
      if (std::exchange(seen.silent, false)) {
        changes.push_back(fmt::format("{} is back after {:.0f} s", now_there.name, silence));
      }
      seen.arrival = now;
      seen.messages = now_there.messages;
    } else if (now_there.steady && !seen.silent && now_there.messages > 0 &&
               now - seen.arrival >= kSilence) {
      seen.silent = true;
      changes.push_back(
          fmt::format("nothing has arrived from {} for {:.0f} s", now_there.name, silence));
    }
    if (now_there.incompatible > seen.incompatible) {
      changes.push_back(fmt::format(
          "a publisher of {} offers less than adit asks for; nothing is received from it. Begin "
          "adit while it publishes: it then asks for less",
          now_there.name));
      seen.incompatible = now_there.incompatible;
    }
    if (now_there.lost > seen.lost && now - seen.loss >= kBetweenLosses) {
      changes.push_back(fmt::format("{} messages of {} were lost on the way",
                                    now_there.lost - seen.lost, now_there.name));
      seen.lost = now_there.lost;
      seen.loss = now;
    }
  }
  return changes;
}

SourceWatch::SourceWatch(std::function<std::vector<SourceCounts>()> received, bool quiet,
                         std::ostream& err) {
  if (quiet) {
    return;
  }
  thread_ = std::jthread([received = std::move(received), &err](const std::stop_token& stop) {
    SourceChanges changes;
    auto next = SourceChanges::Clock::now();
    while (!stop.stop_requested() && StopSignal::received() == 0) {
      const auto now = SourceChanges::Clock::now();
      if (now >= next) {
        for (const std::string& change : changes.look(received(), now)) {
          err << ("note: " + change + "\n") << std::flush;
        }
        next = now + kBetweenLooks;
      }
      std::this_thread::sleep_for(kLookEvery);
    }
  });
}

}  // namespace adit
