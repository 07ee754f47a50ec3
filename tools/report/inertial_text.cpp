// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/inertial_text.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "adit/slam/core/text.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

constexpr std::array kAxes = {"x", "y", "z"};
constexpr std::array kTurns = {"roll", "pitch", "yaw"};

std::string name_of(bool gyroscope) {
  return gyroscope ? "the gyroscope" : "the accelerometer";
}

// What the sweeps say against a gyroscope.

std::string clock_text(const GyroCheck& check) {
  const RotationComparison& found = *check.comparison;
  const double configured = check.configured_offset;
  const bool late = found.offset > 0.0;
  return "the gyroscope turns as the sweeps do, but " +
         with_decimals(1e3 * std::abs(found.offset), 0) + " ms " + (late ? "later" : "earlier") +
         " (+- " + with_decimals(1e3 * kSureSigmas * found.offset_sigma, 0) + " ms, over " +
         std::to_string(check.turns) + " sweeps): its clock is " + (late ? "late" : "early") +
         "; recording.imu_time_offset = " + with_decimals(configured - found.offset, 3) +
         (configured == 0.0 ? "" : " (not " + with_decimals(configured, 3) + ")") +
         " would mend that from the start";
}

std::string mounting_text(const GyroCheck& check) {
  const RotationComparison& found = *check.comparison;
  const Eigen::Quaterniond q(Eigen::Matrix3d(found.R_range_gyro.transpose()));
  const std::string remedy =
      tells_mounting(found) ? ", whose rotation should be qx " + with_decimals(q.x(), 4) + ", qy " +
                                  with_decimals(q.y(), 4) + ", qz " + with_decimals(q.z(), 4) +
                                  ", qw " + with_decimals(q.w(), 4)
                            : "; the motion does not tell its " + names_of_unobserved_axes(found);
  return "the gyroscope turns as the sweeps do, but about axes that are " +
         with_decimals(kDegreesPerRadian * found.misalignment, 1) + " degrees off (over " +
         std::to_string(check.turns) +
         " sweeps): it is mounted otherwise than imu.T_imu_lidar says" + remedy;
}

std::string unit_text(double factor) {
  const bool degrees = std::abs(factor / kDegreesPerRadian - 1.0) < 0.3;
  return "the gyroscope turns " + with_decimals(factor, factor < 1.0 ? 3 : 1) +
         " times as much as the sweeps: " +
         (degrees ? "it is in degrees a second (recording.gyroscope_scale = 0.0174533)"
                  : "is its unit another (recording.gyroscope_scale)?");
}

std::string scale_text(const GyroCheck& check) {
  const RotationComparison& found = *check.comparison;
  return "the gyroscope turns " + with_decimals(found.scale, 3) + " (+- " +
         with_decimals(kSureScaleSigmas * found.scale_sigma, 3) +
         ") times as much as the sweeps, over " + std::to_string(check.turns) +
         " of them: its scale is off; recording.gyroscope_scale = " +
         with_decimals(1.0 / found.scale, 3) + " would mend that";
}

// How a start ended.

struct StartText {
  std::string operator()(const StartedAtRest& start) const {
    return "at rest for " + in_digits(start.duration) + " s" +
           (start.in_g ? ", accelerometer in g" : "");
  }

  std::string operator()(const StartedInMotion& start) const {
    const std::string usual = start.usual_error > 0.0
                                  ? " (the usual one leaves " +
                                        std::to_string(std::lround(start.usual_error)) +
                                        " times the squared error)"
                                  : "";
    return "from " + std::to_string(start.poses) + " poses in motion" +
           (start.in_g ? ", accelerometer in g" : "") +
           (start.negative ? ", accelerometer of the opposite sign" + usual +
                                 ": recording.accelerometer_scale of the opposite sign would mend "
                                 "that from the start"
                           : "");
  }

  std::string operator()(const StartedAfterGap&) const {
    return "readings are back, with the gravity and the biases from before";
  }

  std::string operator()(const TooFewReadings& few) const {
    return std::to_string(few.readings) + " readings over " + in_digits(few.duration) +
           " s; a start at rest needs " + std::to_string(few.needed) + " over " +
           in_digits(few.needed_duration) + " s";
  }

  std::string operator()(const TooFewPoses& few) const {
    return std::to_string(few.poses) + " poses; a start in motion needs " +
           std::to_string(few.needed) + " over half a second";
  }

  std::string operator()(const NotAtRest& moving) const {
    return "the gyroscope varies by " + in_digits(moving.gyro) +
           " rad/s and the accelerometer by " + in_digits(moving.accel) +
           " m/s^2; at rest they stay below " + in_digits(moving.gyro_limit) + " and " +
           in_digits(moving.accel_limit);
  }

  std::string operator()(const SteadyTurn& turn) const {
    return "the gyroscope reads a steady " + in_digits(turn.rate) +
           " rad/s, too much for a bias: a rotation, or degrees per second";
  }

  std::string operator()(const NoGravityAtRest& gravity) const {
    return "the accelerometer reads " + in_digits(gravity.reading) +
           " at rest; 9.8 (m/s^2) or 1 (g) was expected: " +
           (gravity.scale ? "is its scale off? recording.accelerometer_scale = " +
                                in_digits(*gravity.scale, 4) + " would mend that"
                          : "is its unit another?");
  }

  std::string operator()(const NoGravityInMotion& gravity) const {
    return "the motion and the accelerometer together make gravity " +
           std::to_string(gravity.gravity) +
           ", neither 9.8 (m/s^2) nor 1 (g): is the IMU mounted otherwise than stated?";
  }

  std::string operator()(const GravityUnclear& gravity) const {
    return "gravity's direction is known to " + std::to_string(gravity.sigma) +
           " rad only; more or longer motion is needed";
  }
};

// Checks that failed.

std::string impossible_text(const ImpossibleState& state) {
  const std::string value = in_digits(state.value);
  switch (state.quantity) {
    case StateQuantity::prediction:
      return "what the readings say of the motion is not finite";
    case StateQuantity::state:
      return "the fused state is not finite";
    case StateQuantity::acceleration:
      return "the readings say that the sweep before was left with " + value +
             " m/s^2 on average, which nothing that carries a sensor does";
    case StateQuantity::speed:
      return "the fused velocity is " + value + " m/s";
    case StateQuantity::distance:
      return "the fused position moved " + value + " m in " + in_digits(state.elapsed) + " s";
    case StateQuantity::gyro_bias:
      return "the gyroscope's bias would be " + value +
             " rad/s: is it saturated, in degrees, or mounted otherwise than imu.T_imu_lidar says?";
    case StateQuantity::accel_bias:
      return "the accelerometer's bias would be " + value +
             " m/s^2: is its unit another, or imu.T_imu_lidar wrong?";
  }
  return "";
}

std::string questions(const AlignmentsContradict& found) {
  return std::string(found.timed ? ": are clock and imu.T_imu_lidar right?"
                                 : ": the sweeps have no times per point, so motion distorts them; "
                                   "else, are clock and imu.T_imu_lidar right?") +
         (found.sign_assumed ? " And the accelerometer's sign, which the start could not tell "
                               "from a sensor upside down?"
                             : "");
}

struct CheckText {
  bool explained = false;  ///< by what passes

  std::string operator()(const ImpossibleState& state) const { return impossible_text(state); }

  std::string operator()(const StateUndetermined&) const {
    return "the readings and the sweeps do not determine the fused state";
  }

  std::string operator()(const AlignmentsContradict& found) const {
    return std::to_string(found.alignments) +
           " alignments in a row are where the IMU says that they cannot be" +
           (explained ? "" : questions(found));
  }

  std::string operator()(const NotAligned& alone) const {
    return "no sweep could be aligned for " + in_digits(alone.duration) + " s";
  }
};

std::string done_text(const SensorCorrected& corrected) {
  std::string text;
  if (corrected.clock) {
    text = "its clock is corrected by " + with_decimals(-1e3 * *corrected.clock, 1) + " ms";
  }
  if (corrected.turned) {
    const std::string hidden = names_of_unobserved_axes(*corrected.check.comparison);
    text += (text.empty() ? "" : ", ") + std::string("its mounting is turned by ") +
            with_decimals(*corrected.turned * kDegreesPerRadian, 2) + " degrees" +
            (hidden.empty() ? "" : " (the motion does not tell " + hidden + ")");
  }
  return text;
}

struct HindranceText {
  std::string operator()(const NoReadings&) const { return "there are no IMU readings"; }

  std::string operator()(const GapTooLong& gap) const {
    return "no IMU readings for " + in_digits(gap.gap) + " s, longer than " + in_digits(gap.limit) +
           " s (imu.max_gap)";
  }

  std::string operator()(const StuckAxis& stuck) const { return describe(stuck); }

  std::string operator()(const FewAligned& few) const {
    return "only " + std::to_string(few.sweeps) + " sweeps over " + in_digits(few.duration) +
           " s in a row are aligned and have IMU readings between them; a start needs " +
           std::to_string(few.needed) + " over " + in_digits(few.needed_duration) + " s";
  }

  std::string operator()(const UnitChanged&) const {
    return "the readings look as if their unit or sign had changed since the last start";
  }

  std::string operator()(const SignUnclear&) const {
    return "the motion does not tell yet whether the accelerometer's sign is the opposite one";
  }

  std::string operator()(const ImuStartReason& reason) const { return describe(reason); }
};

struct CauseText {
  bool explained = false;  ///< by what passes

  std::string operator()(const Saturation& saturation) const { return describe(saturation); }

  std::string operator()(const SensorStarted& start) const {
    return "started: " + describe(start.how);
  }

  std::string operator()(const NoReadings& none) const { return HindranceText{}(none); }

  std::string operator()(const GapTooLong& gap) const { return HindranceText{}(gap); }

  std::string operator()(const StuckAxis& stuck) const {
    return describe(stuck) + ": is it broken? Check it with adit inspect";
  }

  std::string operator()(const CheckFailed& failed) const {
    return std::visit(CheckText{explained}, failed.check) +
           (failed.refused ? "; lost " + std::to_string(failed.losses) +
                                 " times, so it is not used any more: check its mounting "
                                 "(imu.T_imu_lidar), its clock and its units with adit inspect"
                           : "");
  }

  std::string operator()(const SensorCorrected& corrected) const {
    const std::string fault = describe(corrected.check);
    return (fault.empty() ? "" : fault + "; ") + done_text(corrected) +
           ", as the sweeps' turns say; starting anew";
  }

  std::string operator()(const GyroscopeDisagrees& found) const {
    return describe(found.check) + (found.refused ? "; it is not used any more"
                                                  : "; the lidar goes alone until that is clear");
  }

  std::string operator()(const PredictsWorse& worse) const {
    return "corrected as the sweeps' turns say, it still predicts their turns worse than constant "
           "velocity (better in " +
           std::to_string(worse.better) + " of " + std::to_string(worse.sweeps) +
           "); it is not used any more";
  }
};

struct PassingText {
  std::string operator()(const Saturation& saturation) const { return describe(saturation); }

  std::string operator()(const GapBridged&) const {
    return "readings were missing shortly before, and what they would have said was guessed";
  }
};

}  // namespace

std::string describe(const InertialEvent& event) {
  const std::string text = std::visit(CauseText{event.passing.has_value()}, event.cause);
  return event.passing ? text + "; " + std::visit(PassingText{}, *event.passing) : text;
}

std::string describe(const InertialHindrance& hindrance) {
  return std::visit(HindranceText{}, hindrance);
}

std::string describe(const ImuStartReason& reason) {
  return std::visit(StartText{}, reason);
}

std::string describe(const StuckAxis& stuck) {
  return name_of(stuck.gyroscope) + "'s " + kAxes.at(static_cast<std::size_t>(stuck.axis)) +
         " stays at " + in_digits(stuck.value) + " for " + in_digits(stuck.duration) +
         " s while its other axes move";
}

std::string describe(const Saturation& saturation) {
  return name_of(saturation.gyroscope) + " is saturated: " + std::to_string(saturation.readings) +
         (saturation.readings == 1 ? " reading stands at " : " readings stand at ") +
         in_digits(saturation.limit, 4) + (saturation.gyroscope ? " rad/s" : "") +
         ", the end of its range";
}

std::string describe(const GyroCheck& check) {
  const std::string over = " over " + std::to_string(check.turns) + " sweeps";
  switch (check.fault) {
    case GyroFault::none:
      return "";
    case GyroFault::constant:
      return "the gyroscope stays as it is while the sweeps turn" + over +
             ": is it broken, or a message filled in?";
    case GyroFault::unrelated:
      return "the gyroscope's turns have little to do with those of the sweeps" + over +
             ": is it of another recording, its clock off by more than 0.3 s, or saturated?";
    case GyroFault::unit:
      return unit_text(check.factor);
    case GyroFault::scale:
      return scale_text(check);
    case GyroFault::clock:
      return clock_text(check);
    case GyroFault::mounting:
      return mounting_text(check);
  }
  return "";
}

std::string names_of_unobserved_axes(const RotationComparison& comparison) {
  const std::array<bool, 3> hidden = unobserved_axes(comparison);
  std::string text;
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    if (hidden[i]) {
      text += (text.empty() ? "" : ", ") + std::string(kTurns[i]);
    }
  }
  return text;
}

}  // namespace adit
