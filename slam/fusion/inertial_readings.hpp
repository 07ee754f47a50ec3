// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/fusion/inertial_event.hpp"
#include "adit/slam/inertial/imu_buffer.hpp"
#include "adit/slam/inertial/reading_gate.hpp"

namespace adit {

/// What is wrong with how readings cover a time; none if nothing is. Up to `max_gap` (s) without
/// readings are bridged.
std::optional<CoverageFault> coverage_fault(const ImuInterval& interval, double max_gap);

/// The readings of an inertial sensor: gated, in order of time, on the sweeps' clock, and watched
/// for what is wrong with them themselves.
class InertialReadings {
 public:
  explicit InertialReadings(const ImuConfig& config);

  /// Takes a reading. Returns those whose fate is known with it, with their own stamps: one that
  /// jumps waits for the next.
  std::vector<TakenReading> add(const ImuSample& sample);

  ImuInterval between(Nanoseconds begin, Nanoseconds end) const {
    return buffer_.between(begin, end);
  }
  std::optional<Nanoseconds> newest() const {
    return buffer_.empty() ? std::nullopt : std::optional(buffer_.back().stamp);
  }

  /// An axis that is stuck as of the newest reading.
  std::optional<StuckAxis> stuck() const { return stuck_.stuck(); }
  /// One that may be: it has stayed as it is since then, while the others change, however little.
  std::optional<StuckAxis> unchanged_axis(Nanoseconds since) const {
    return stuck_.unchanged(since);
  }
  /// Saturation in that time, where there was none in the ten seconds before it.
  std::optional<Saturation> saturation_begins(Nanoseconds begin, Nanoseconds end) const;
  /// In the ten seconds up to the newest reading.
  std::optional<Saturation> recent_saturation() const;
  /// Stamps of the gyroscope's readings that are saturated, as they came, in order of time.
  std::vector<Nanoseconds> saturated_gyroscope() const;

  /// s, taken off the stamps of readings.
  double clock_offset() const { return clock_offset_; }
  /// From now on; what is kept is moved as well.
  void correct_clock(double offset);

  /// Drops what no interval from `stamp` on needs.
  void forget_before(Nanoseconds stamp);

 private:
  /// Saturation is reported when none was for so long, and with what else goes wrong in that time.
  static constexpr Nanoseconds kToldAgain = std::chrono::seconds(10);

  ImuArrival take(const ImuSample& sample);

  ReadingGate gate_;
  ImuBuffer buffer_;
  SaturationWatch saturation_;
  StuckAxisWatch stuck_;
  double clock_offset_ = 0.0;
};

}  // namespace adit
