// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>

#include "adit/slam/core/types.hpp"

namespace adit {

/// Readings that stand at the end of a sensor's range.
struct Saturation {
  bool gyroscope = true;     ///< else the accelerometer
  std::size_t readings = 0;  ///< that stand there
  double limit = 0.0;        ///< the end of the range: rad/s, or the accelerometer's own unit
};

/// Finds readings that stand at the end of a sensor's range: an axis that repeats the greatest
/// value so far, bit for bit, three times or more while others move. A motion does not do that, nor
/// does a message that comes twice.
class SaturationWatch {
 public:
  /// The next reading, in order of time.
  void add(const ImuSample& sample);

  /// Readings after `begin` and up to `end` that stand there, those of the gyroscope before those
  /// of the accelerometer; none if none do.
  std::optional<Saturation> between(Nanoseconds begin, Nanoseconds end) const;

  /// Stamps of the gyroscope's readings that stand there, in order of time.
  const std::deque<Nanoseconds>& of_gyroscope() const { return gyroscope_.saturated; }

  void forget_before(Nanoseconds stamp);
  /// Adds to the stamps of what is kept, as ImuBuffer::shift().
  void shift(Nanoseconds by);

 private:
  /// Three axes of a kind.
  struct Triad {
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    std::array<int, 3> repeats = {0, 0, 0};
    double greatest = 0.0;
    double limit = 0.0;  ///< the end of the range, once it is known
    std::deque<Nanoseconds> saturated;

    /// `stamps`: of this reading, after the last two; `least`: no range ends below; `stuck`: the
    /// whole message is the one before.
    void add(const Eigen::Vector3d& value, const std::array<Nanoseconds, 3>& stamps, double least,
             bool stuck);
  };

  Triad gyroscope_;
  Triad accelerometer_;
  std::array<Nanoseconds, 3> stamps_ = {};  ///< times of the last three readings
  double usual_ = 0.0;  ///< length of accelerations, in the sensor's unit: about gravity
};

}  // namespace adit
