// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <variant>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/types.hpp"

namespace adit {

/// What sensors measure, as it enters the system.
using Measurement = std::variant<Sweep, ImuSample, GnssFix, BodyVelocity, Heading>;

/// The measurement's own time; of a sweep that of its start.
Nanoseconds stamp_of(const Measurement& measurement);

/// Puts measurements that arrive in any order into the order in which the odometry wants them: by
/// their own stamps, and a sweep once the inertial readings that cover it have been handed on.
///
/// - A measurement is held until one has arrived whose stamp is `window` later; what is later than
///   that comes at once, behind measurements with later stamps, and is never lost.
/// - A sweep waits for a reading at its end, for 0.3 s of the sensors' own time at most, since the
///   inertial sensor may have stopped.
/// - Memory is bounded: beyond 256 MiB of sweeps the first ones go as they are.
///
/// Only stamps decide, never a clock on the wall: the same arrivals give the same order. Without an
/// inertial sensor nothing waits.
class SensorFeed {
 public:
  /// `inertial`: there is an inertial sensor to wait for.
  explicit SensorFeed(bool inertial, Nanoseconds window = nanoseconds(ImuConfig{}.wait))
      : waits_(inertial), window_(window) {}

  void add(Measurement measurement);

  /// Nothing more comes for now: all that is held is due, in its order. add() may go on after that.
  void flush();

  /// The next that is due; nothing where that must wait.
  std::optional<Measurement> next();

 private:
  /// For readings that cover it.
  struct WaitingSweep {
    Sweep sweep;
    Nanoseconds end{0};  ///< of its last point; readings are asked about it one by one
  };

  bool is_due() const;
  bool front_is_covered() const;
  void release(Measurement measurement);

  bool waits_;
  Nanoseconds window_;
  bool flushing_ = false;
  std::multimap<Nanoseconds, Measurement> held_;  ///< by stamp
  std::size_t held_bytes_ = 0;
  Nanoseconds latest_arrival_ = Nanoseconds::min() / 2;  ///< differences from it do not overflow
  std::deque<WaitingSweep> waiting_;                     ///< in order
  std::deque<Measurement> ready_;                        ///< readings and fixes
  Nanoseconds newest_reading_ = Nanoseconds::min();
  Nanoseconds newest_ = Nanoseconds::min();
};

}  // namespace adit
