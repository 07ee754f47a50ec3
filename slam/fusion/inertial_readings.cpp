// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/inertial_readings.hpp"

#include <algorithm>

#include "adit/slam/inertial/preintegration.hpp"

namespace adit {
std::optional<CoverageFault> coverage_fault(const ImuInterval& interval, double max_gap) {
  if (interval.samples.empty()) {
    return NoReadings{};
  }
  // A gap is bridged between its ends; where one of them is missing, nothing tells what comes.
  const double held = std::max(interval.held_before, interval.held_after);
  const double longest_held = std::min(max_gap, kReadingGap);
  if (interval.longest_gap <= max_gap && held <= longest_held) {
    return std::nullopt;
  }
  const double gap = interval.longest_silence();
  return GapTooLong{.gap = gap, .limit = gap > max_gap ? max_gap : longest_held};
}

InertialReadings::InertialReadings(const ImuConfig& config)
    : gate_({.rate = config.max_rate, .acceleration = config.max_acceleration}) {}

std::vector<TakenReading> InertialReadings::add(const ImuSample& sample) {
  std::vector<TakenReading> taken;
  for (const GatedReading& known : gate_.pass(sample)) {
    taken.push_back({known.sample, known.dropped ? *known.dropped : take(known.sample)});
  }
  return taken;
}

ImuArrival InertialReadings::take(const ImuSample& sample) {
  ImuSample corrected = sample;
  corrected.stamp -= nanoseconds(clock_offset_);
  const ImuArrival arrival = buffer_.push(corrected);
  if (arrival == ImuArrival::restarted) {
    saturation_ = {};
    stuck_ = {};
  }
  if (arrival == ImuArrival::appended || arrival == ImuArrival::restarted) {
    saturation_.add(corrected);
    stuck_.add(corrected);
  }
  return arrival;
}

std::optional<Saturation> InertialReadings::saturation_begins(Nanoseconds begin,
                                                              Nanoseconds end) const {
  return saturation_.between(begin - kToldAgain, begin) ? std::nullopt
                                                        : saturation_.between(begin, end);
}

std::optional<Saturation> InertialReadings::recent_saturation() const {
  const auto last = newest();
  return last ? saturation_.between(*last - kToldAgain, *last) : std::nullopt;
}

std::vector<Nanoseconds> InertialReadings::saturated_gyroscope() const {
  std::vector<Nanoseconds> stamps;
  for (const Nanoseconds stamp : saturation_.of_gyroscope()) {
    stamps.push_back(stamp + nanoseconds(clock_offset_));
  }
  return stamps;
}

void InertialReadings::correct_clock(double offset) {
  const Nanoseconds by = -nanoseconds(offset - clock_offset_);
  clock_offset_ = offset;
  buffer_.shift(by);
  saturation_.shift(by);
}

void InertialReadings::forget_before(Nanoseconds stamp) {
  buffer_.forget_before(stamp - std::chrono::milliseconds(100));
  saturation_.forget_before(stamp - 2 * kToldAgain);
}

}  // namespace adit
