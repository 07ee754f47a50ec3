// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// What became of a sample.
enum class ImuArrival {
  appended,
  inserted,    ///< it came late, after newer ones, and was put in its place
  duplicate,   ///< there is one with this stamp already: dropped
  too_late,    ///< older than everything that is kept: dropped
  restarted,   ///< more than a second older than the newest: the clock was set back, and what was
               ///< kept is of another clock and dropped
  not_finite,  ///< NaN or infinite: dropped
  impossible,  ///< beyond what sensors read (imu.max_rate, imu.max_acceleration): dropped
  spike,       ///< far from the readings before and after it, which agree: dropped
};
std::string_view to_string(ImuArrival arrival);
constexpr std::size_t kImuArrivals = 8;

/// A reading, and what became of it.
struct TakenReading {
  ImuSample sample;
  ImuArrival arrival = ImuArrival::appended;
};

/// The readings of a span of time, as preintegration wants them: the first at its begin, the last
/// at its end, both interpolated linearly between their neighbours.
struct ImuInterval {
  std::vector<ImuSample>
      samples;               ///< in order of time; empty: the buffer has none, or end <= begin
  double held_before = 0.0;  ///< s at the begin, without readings: the first one was held
  double held_after = 0.0;   ///< s at the end, without readings: the last one was held
  double longest_gap = 0.0;  ///< s between neighbouring readings

  /// The longest time without a reading, s.
  double longest_silence() const { return std::max({held_before, held_after, longest_gap}); }
};

/// The latest readings of an inertial sensor in order of their stamps.
class ImuBuffer {
 public:
  /// Takes a sample; those whose stamps or values cannot be right are dropped, and said to be.
  ImuArrival push(const ImuSample& sample);

  /// The readings from `begin` to `end`. Where the buffer does not reach, its nearest reading is
  /// held, and how long is reported: the caller judges that.
  ImuInterval between(Nanoseconds begin, Nanoseconds end) const;

  /// Drops samples that no interval from `stamp` on needs.
  void forget_before(Nanoseconds stamp);

  /// Adds to the stamps of all that is kept: the clock turned out to be off.
  void shift(Nanoseconds by);

  bool empty() const { return samples_.empty(); }
  std::size_t size() const { return samples_.size(); }
  /// The oldest and the newest reading; the buffer is not empty.
  const ImuSample& front() const { return samples_.front(); }
  const ImuSample& back() const { return samples_.back(); }

 private:
  std::deque<ImuSample> samples_;
};

/// The reading at `stamp`, linearly between two others (or beyond them).
ImuSample interpolate(const ImuSample& a, const ImuSample& b, Nanoseconds stamp);

}  // namespace adit
