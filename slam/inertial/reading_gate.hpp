// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/inertial/imu_buffer.hpp"

namespace adit {

/// What no axis of a sensor that works reads more than.
struct ReadingLimits {
  double rate = 5000.0;          ///< rad/s
  double acceleration = 2000.0;  ///< m/s²
};

/// A reading whose fate is known.
struct GatedReading {
  ImuSample sample;
  std::optional<ImuArrival> dropped;  ///< why; none: it passes
};

/// What is usual of a quantity: follows a quantile of its values, however far off outliers are.
class UsualValue {
 public:
  /// `share` of the values are below.
  explicit UsualValue(double share) : share_(share) {}
  void add(double value);
  double get() const { return value_; }  ///< 0 before the first

 private:
  double share_;
  double value_ = 0.0;
  int count_ = 0;
};

/// Keeps damaged readings of an inertial sensor out (docs/theory/inertial.md, section 6). A reading
/// about as far from the one before as readings usually are passes at once. One that jumps waits
/// for the next: where they go on from it, as after a shock or a step, all pass in their order;
/// where they go on from the one before it, it was a spike. So were up to three in a row, if only
/// one of the six numbers jumped, there at once and back at once.
class ReadingGate {
 public:
  explicit ReadingGate(const ReadingLimits& limits) : limits_(limits) {}

  /// Takes the next reading. Returns those whose fate is known with it, in the order they came.
  std::vector<GatedReading> pass(const ImuSample& reading);

 private:
  struct Scales {
    double turn = 0.0;   ///< rad/s
    double force = 0.0;  ///< m/s²
  };
  /// Changes beyond these are jumps.
  Scales jumps() const;
  /// Between two readings: what is beyond 1 is a jump.
  double distance(const ImuSample& a, const ImuSample& b) const;
  /// Whether the way there and the way on lead to the same side.
  bool sticks_out(const ImuSample& before, const ImuSample& one, const ImuSample& after) const;
  /// Which of the six numbers jumps (1 to 6) and to which side (sign), where it is only one.
  std::optional<int> lone_jump(const ImuSample& usual, const ImuSample& one) const;
  /// Whether those that wait last could be spikes in a row.
  bool may_be_burst() const;
  /// Nothing can be called a jump: what is usual is not known yet, or the motion has changed.
  bool has_changed() const;
  /// Whether the last that waits tells what the others are.
  bool is_settled() const;
  bool is_spike(std::size_t waiting) const;
  void learn(const ImuSample& passed);

  ReadingLimits limits_;
  UsualValue turn_change_{0.75};   ///< rad/s, from one to the next
  UsualValue force_change_{0.75};  ///< m/s²
  UsualValue force_{0.5};          ///< m/s²: gravity, in the sensor's unit
  std::optional<ImuSample> last_;  ///< that passed
  int passed_ = 0;
  int calm_ = 0;                    ///< passed at once, in a row
  std::vector<ImuSample> waiting_;  ///< in the order they came
};

}  // namespace adit
