// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What happens to an inertial sensor, as values; tools/report/inertial_text makes sentences of
// them.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <variant>

#include "adit/slam/inertial/gyro_monitor.hpp"
#include "adit/slam/inertial/imu_start.hpp"
#include "adit/slam/inertial/saturation.hpp"
#include "adit/slam/inertial/stuck_axis.hpp"

namespace adit {

/// Nothing was read in a time that needs readings.
struct NoReadings {};

/// Readings are missing for longer than may be bridged: for longer than the limit, or for longer
/// than kReadingGap at an end, beyond which nothing was read yet.
struct GapTooLong {
  double gap = 0.0;    ///< s, the longest
  double limit = 0.0;  ///< s: imu.max_gap, or less where one end of the gap is missing
};

/// Why readings do not cover a time.
using CoverageFault = std::variant<NoReadings, GapTooLong>;

/// A start would be with another unit or sign of the accelerometer than the one before.
struct UnitChanged {};

/// The accelerometer's sign was an assumption with which a check failed, and the motion since does
/// not tell it either: the other fits better, but not clearly.
struct SignUnclear {};

/// Too few sweeps could be aligned, and have readings between them, one after another.
struct FewAligned {
  std::size_t sweeps = 0;
  double duration = 0.0;         ///< s
  std::size_t needed = 0;        ///< sweeps
  double needed_duration = 0.0;  ///< s
};

/// What keeps a sensor from being started.
using InertialHindrance = std::variant<NoReadings, GapTooLong, StuckAxis, FewAligned, UnitChanged,
                                       SignUnclear, ImuStartReason>;

/// What is held to bounds before and after a sweep is fused.
enum class StateQuantity {
  prediction,    ///< where readings lead, with its covariance: not finite
  state,         ///< the fused state, with its covariance: not finite
  acceleration,  ///< m/s², the mean since the last sweep, by the readings
  speed,         ///< m/s, of the fused state
  distance,      ///< m, between two fused states
  gyro_bias,     ///< rad/s
  accel_bias,    ///< m/s²
};
std::string_view to_string(StateQuantity quantity);

/// A state in which no sensor can be.
struct ImpossibleState {
  StateQuantity quantity = StateQuantity::state;
  double value = 0.0;    ///< in the quantity's unit; 0 where it is not finite
  double limit = 0.0;    ///< what it must not exceed; 0 where it is not finite
  double elapsed = 0.0;  ///< s, in which the distance was covered
};

/// Alignments in a row are where the sensor says that they cannot be.
struct AlignmentsContradict {
  int alignments = 0;
  bool timed = true;          ///< points have times; without, motion distorts sweeps
  bool sign_assumed = false;  ///< the accelerometer's sign, by a start that could not tell it
};

/// Readings and sweeps together do not determine the state: no covariance can be computed.
struct StateUndetermined {};

/// No sweep could be aligned for so long.
struct NotAligned {
  double duration = 0.0;  ///< s
  double limit = 0.0;     ///< s
};

/// Which check of a sweep failed.
using FailedCheck =
    std::variant<ImpossibleState, StateUndetermined, AlignmentsContradict, NotAligned>;

/// The sensor is fused from now on.
struct SensorStarted {
  ImuStartReason how;
  Nanoseconds since{0};  ///< stamp of the first sweep that it is started from
};

/// A check failed.
struct CheckFailed {
  FailedCheck check;
  int losses = 0;        ///< by now, without a long time of fusion in between
  bool refused = false;  ///< they are too many
};

/// The sensor was corrected as the sweeps' turns say, and is started anew.
struct SensorCorrected {
  GyroCheck check;                 ///< what they say; its fault is `none` for a refinement
  std::optional<double> clock{};   ///< s, taken off stamps from now on, where that was changed
  std::optional<double> turned{};  ///< rad, by which the mounting was turned, where it was
};

/// The gyroscope does not turn as the sweeps do, and cannot be corrected.
struct GyroscopeDisagrees {
  GyroCheck check;
  bool refused = false;  ///< they said so before; else the lidar goes alone until that is clear
};

/// A sensor that was corrected predicts turns worse than constant velocity: it is refused.
struct PredictsWorse {
  int better = 0;  ///< sweeps whose turn it predicted better
  int sweeps = 0;
};

/// What happened. Saturation is a warning; all others come with a change of state.
using InertialCause = std::variant<Saturation, SensorStarted, NoReadings, GapTooLong, StuckAxis,
                                   CheckFailed, SensorCorrected, GyroscopeDisagrees, PredictsWorse>;
/// Its kind: "sensor started", "gap too long", ...
std::string_view to_string(const InertialCause& cause);

/// Readings were missing shortly before, and what they would have said was guessed.
struct GapBridged {};

/// What else explains that something failed, and passes.
using PassingCause = std::variant<Saturation, GapBridged>;

struct InertialEvent {
  InertialCause cause;
  std::optional<PassingCause> passing{};
};

}  // namespace adit
