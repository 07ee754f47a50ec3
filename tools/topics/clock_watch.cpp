// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/topics/clock_watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace adit {
namespace {

constexpr double kLeastStep = 1.0;           // s: receipts may be late by less
constexpr std::size_t kMostStretches = 256;  // a clock that leaps more often is none
constexpr uint64_t kFewestMessages = 3;      // fewer are stray stamps

void join(ClockStretch& one, const ClockStretch& next) {
  one.events += next.events;
  one.last = next.last;
  one.least = std::min(one.least, next.least);
  one.greatest = std::max(one.greatest, next.greatest);
  one.least_delay = std::min(one.least_delay, next.least_delay);
  one.sum_of_delays += next.sum_of_delays;
}

}  // namespace

void ClockWatch::add(Nanoseconds received, Nanoseconds stamp) {
  const double delay = seconds(received - stamp);
  const ClockStretch one{.events = 1,
                         .begin = received,
                         .first = stamp,
                         .last = stamp,
                         .least = stamp,
                         .greatest = stamp,
                         .least_delay = delay,
                         .sum_of_delays = delay};
  if (stretches_.empty()) {
    stretches_.push_back(one);
  } else {
    // Delayed messages come at once with stamps that go on; stamps of a clock that steps do not.
    const double advance = seconds(stamp - stretches_.back().last);
    const double leap = advance - seconds(received - last_received_);
    // A recorder that stamps several messages alike has no clock to compare with.
    const bool steps = received > last_received_ && std::abs(leap) > kLeastStep &&
                       (advance < -kLeastStep || leap > 0.0);
    if (steps && stretches_.size() < kMostStretches) {
      stretches_.push_back(one);
    } else {
      join(stretches_.back(), one);
    }
  }
  last_received_ = received;
}

std::vector<ClockStretch> ClockWatch::joined() const {
  const bool some = std::ranges::any_of(
      stretches_, [](const ClockStretch& one) { return one.events >= kFewestMessages; });
  std::vector<ClockStretch> all;
  for (const ClockStretch& one : stretches_) {
    if (some && one.events < kFewestMessages) {
      continue;
    }
    const bool alike =
        !all.empty() && std::abs(one.least_delay - all.back().least_delay) < kLeastStep;
    if (!all.empty() && (alike || !some)) {
      join(all.back(), one);
    } else {
      all.push_back(one);
    }
  }
  return all;
}

std::vector<ClockStep> ClockWatch::steps() const {
  const std::vector<ClockStretch> all = joined();
  std::vector<ClockStep> steps;
  for (std::size_t i = 1; i < all.size(); ++i) {
    steps.push_back({.seconds = all[i - 1].least_delay - all[i].least_delay,
                     .after = seconds(all[i].begin - stretches_.front().begin),
                     .before = all[i - 1].last,
                     .stamp = all[i].first});
  }
  return steps;
}

double ClockWatch::typical_delay() const {
  const std::vector<ClockStretch> all = joined();
  const auto most = std::ranges::max_element(all, {}, &ClockStretch::events);
  return most == all.end() ? 0.0 : most->mean_delay();
}

double ClockWatch::span() const {
  double sum = 0.0;
  for (const ClockStretch& one : joined()) {
    sum += seconds(one.greatest - one.least);
  }
  return sum;
}

}  // namespace adit
