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
  /// `share` of the values are below. From the first values, one at least.
  UsualValue(double share, std::vector<double> first);
  void add(double value);
  double get() const { return value_; }

 private:
  double share_;
  double value_ = 0.0;
};

/// Keeps damaged readings of an inertial sensor out (docs/theory/inertial.md, section 6). The first
/// twenty wait until all of them are there and tell what is usual. From then on a reading about as
/// far from the one before as readings usually are passes at once. One that jumps waits for the
/// next: where they go on from it, as after a shock or a step, all pass in their order; where they
/// go on from the one before it, it was a spike. So were up to three in a row, if only one of the
/// six numbers jumped, there at once and back at once.
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
  /// What is usual, and the reading that passed last.
  struct Usual {
    UsualValue turn_change;   ///< rad/s, from one to the next
    UsualValue force_change;  ///< m/s²
    UsualValue force;         ///< m/s²: gravity, in the sensor's unit
    ImuSample last;
  };
  static Usual usual_of(const std::vector<ImuSample>& first);
  /// Once the first are there: what is usual, then they one after the other.
  std::vector<GatedReading> begin();
  /// Takes a reading for which it is known what is usual.
  std::vector<GatedReading> settle(const ImuSample& reading);
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
  /// Nothing can be called a jump: the motion has changed.
  bool has_changed() const;
  /// All that wait but the last had one number off each, not always the same, and the last has
  /// none: no motion does that.
  bool is_past_spikes() const;
  /// Whether the last that waits tells what the others are.
  bool is_settled() const;
  bool is_spike(std::size_t waiting) const;
  void learn(const ImuSample& passed);

  ReadingLimits limits_;
  std::vector<ImuSample> first_;    ///< in the order they came, until what is usual is known
  std::optional<Usual> usual_;      ///< none before that
  int calm_ = 0;                    ///< passed at once, in a row
  std::vector<ImuSample> waiting_;  ///< in the order they came
};

}  // namespace adit
