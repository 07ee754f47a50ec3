// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/clock_findings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include "adit/slam/core/text.hpp"

namespace adit {
namespace {

constexpr const char* kSetToUtc = "Set the sensor's clock to UTC, or shift its times";

/// What an offset between two clocks looks like, where it is one that is known; empty otherwise.
std::string known_offset(double seconds) {
  struct Known {
    double seconds;
    const char* name;
  };
  constexpr Known kKnown[] = {{37.0, "the difference of TAI and UTC"},
                              {18.0, "the difference of GPS time and UTC"},
                              {19.0, "the difference of TAI and GPS time"}};
  for (const Known& known : kKnown) {
    if (std::abs(std::abs(seconds) - known.seconds) < 0.5) {
      return known.name;
    }
  }
  return {};
}

/// Counts from when the sensor was started: more than three years behind the recorder's clock.
bool counts_since_start(double delay) {
  return delay > 1e8;
}

void check_clock_step(const ClockStep& step, TopicFindings& findings) {
  const std::string at = with_decimals(step.after, 3) + " s after its first message";
  const double stamp = seconds(step.stamp);
  if (step.seconds < 0.0 && stamp < 1e8) {
    findings.problem("clock_restart",
                     "its clock restarts " + at + ": it falls back by " +
                         with_decimals(-step.seconds, 3) + " s and counts on from " +
                         with_decimals(stamp, 3) + " s",
                     "what comes after the restart does not fit to what came before",
                     "Map the parts before and after it on their own (--start, --count)");
    return;
  }
  const std::string known = known_offset(step.seconds);
  findings.problem("clock_leap",
                   "its clock leaps by " + with_decimals(step.seconds, 3) +
                       " s against the recorder's " + at + (known.empty() ? "" : ": " + known),
                   "before or after the leap it does not fit to the other topics",
                   known.empty()
                       ? "Synchronise the clocks (PTP, GPS, NTP), or map the parts before "
                         "and after it on their own (--start, --count)"
                       : kSetToUtc);
}

}  // namespace

void check_clock(const Topic& topic, const TopicStatistics& s, bool shared,
                 TopicFindings& findings) {
  const std::vector<ClockStep> steps =
      topic.kind == TopicKind::poses ? std::vector<ClockStep>{} : s.clock.steps();
  constexpr std::size_t kListed = 3;
  for (std::size_t i = 0; i < std::min(kListed, steps.size()); ++i) {
    check_clock_step(steps[i], findings);
  }
  if (steps.size() > kListed) {
    findings.problem("clock_leap",
                     "its clock leaps " + std::to_string(steps.size() - kListed) + " more times",
                     "", "");
  }
  const double delay = topic.kind == TopicKind::poses ? s.delay.mean() : s.clock.typical_delay();
  if (!steps.empty() || std::abs(delay) < 1.0) {
    return;
  }
  const std::string known = known_offset(delay);
  const bool since_start = counts_since_start(delay);
  const std::string found = "its clock is " + with_decimals(std::abs(delay), 3) + " s " +
                            (delay > 0 ? "behind" : "ahead of") + " the recorder's" +
                            (!known.empty() ? ": " + known
                             : since_start  ? ": it counts from when the sensor was started"
                                            : "");
  const std::string remedy = known.empty() && !since_start
                                 ? "Synchronise the clocks (PTP, GPS, NTP)"
                                 : std::string(kSetToUtc);
  if (topic.kind == TopicKind::poses) {
    findings.notice("clock_offset", found, "none for mapping, which does not use them", remedy);
  } else if (shared) {
    findings.handled("clock_offset", found,
                     "no other sensor of the recording has another clock, and only their "
                     "differences count");
  } else {
    findings.problem("clock_offset", found, "it does not fit to topics whose clock is right",
                     remedy);
  }
}

bool share_a_clock(const std::vector<Topic>& topics, const std::vector<TopicStatistics>& statistics,
                   const std::vector<bool>& used) {
  std::optional<double> least;
  double greatest = 0.0;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const TopicKind kind = topics[i].kind;
    const bool sensor = kind == TopicKind::sweeps || kind == TopicKind::imu ||
                        kind == TopicKind::gnss || kind == TopicKind::velocities ||
                        kind == TopicKind::headings;
    if (sensor && used[i] && statistics[i].events > 0) {
      const double delay = statistics[i].clock.typical_delay();
      greatest = least ? std::max(greatest, delay) : delay;
      least = std::min(least.value_or(delay), delay);
    }
  }
  return least && greatest - *least < 1.0;
}

}  // namespace adit
