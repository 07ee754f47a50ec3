// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What happens to an inertial sensor, each event as people read it.
#include "adit/tools/report/inertial_text.hpp"

#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace adit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string text_of(const InertialCause& cause) {
  return describe(InertialEvent{.cause = cause});
}

std::string text_of(const InertialHindrance& hindrance) {
  return describe(hindrance);
}

std::string explained(const InertialCause& cause, const PassingCause& passing) {
  return describe(InertialEvent{.cause = cause, .passing = passing});
}

GyroCheck check(GyroFault fault) {
  GyroCheck check{.fault = fault, .turns = 30};
  check.comparison.emplace();
  check.comparison->offset = 0.1004;
  check.comparison->offset_sigma = 0.0005;
  check.comparison->scale = 1.1;
  check.comparison->scale_sigma = 0.0025;
  check.comparison->R_range_gyro =
      Eigen::AngleAxisd(-0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  check.comparison->misalignment = 0.5 * std::numbers::pi;
  return check;
}

TEST(InertialText, Saturation) {
  EXPECT_EQ(text_of(InertialCause(Saturation{.gyroscope = true, .readings = 1, .limit = 2.0})),
            "the gyroscope is saturated: 1 reading stands at 2 rad/s, the end of its range");
  EXPECT_EQ(text_of(InertialCause(Saturation{.gyroscope = false, .readings = 3, .limit = 156.96})),
            "the accelerometer is saturated: 3 readings stand at 157, the end of its range");
}

TEST(InertialText, Starts) {
  const auto started = [](const ImuStartReason& how) {
    return text_of(InertialCause(SensorStarted{.how = how}));
  };
  EXPECT_EQ(started(StartedAtRest{.duration = 1.0}), "started: at rest for 1 s");
  EXPECT_EQ(started(StartedAtRest{.duration = 1.234, .in_g = true}),
            "started: at rest for 1.23 s, accelerometer in g");
  EXPECT_EQ(started(StartedInMotion{.poses = 11}), "started: from 11 poses in motion");
  EXPECT_EQ(
      started(StartedInMotion{.poses = 11, .in_g = true, .negative = true, .usual_error = 12.4}),
      "started: from 11 poses in motion, accelerometer in g, accelerometer of the opposite sign "
      "(the usual one leaves 12 times the squared error): recording.accelerometer_scale of the "
      "opposite sign would mend that from the start");
  EXPECT_EQ(started(StartedInMotion{.poses = 11, .negative = true}),
            "started: from 11 poses in motion, accelerometer of the opposite sign: "
            "recording.accelerometer_scale of the opposite sign would mend that from the start");
  EXPECT_EQ(started(StartedAfterGap{}),
            "started: readings are back, with the gravity and the biases from before");
}

TEST(InertialText, StartsThatWereRefused) {
  EXPECT_EQ(describe(ImuStartReason(TooFewReadings{
                .readings = 12, .duration = 0.12345, .needed = 20, .needed_duration = 0.5})),
            "12 readings over 0.123 s; a start at rest needs 20 over 0.5 s");
  EXPECT_EQ(describe(ImuStartReason(TooFewPoses{.poses = 4, .needed = 6})),
            "4 poses; a start in motion needs 6 over half a second");
  EXPECT_EQ(describe(ImuStartReason(
                NotAtRest{.gyro = 0.5, .accel = 1.234567, .gyro_limit = 0.02, .accel_limit = 0.3})),
            "the gyroscope varies by 0.5 rad/s and the accelerometer by 1.23 m/s^2; at rest they "
            "stay below 0.02 and 0.3");
  EXPECT_EQ(describe(ImuStartReason(SteadyTurn{.rate = 0.5})),
            "the gyroscope reads a steady 0.5 rad/s, too much for a bias: a rotation, or degrees "
            "per second");
  EXPECT_EQ(describe(ImuStartReason(NoGravityAtRest{.reading = 3.92266})),
            "the accelerometer reads 3.92 at rest; 9.8 (m/s^2) or 1 (g) was expected: is its unit "
            "another?");
  EXPECT_EQ(describe(ImuStartReason(NoGravityAtRest{.reading = 12.258, .scale = 0.80002})),
            "the accelerometer reads 12.3 at rest; 9.8 (m/s^2) or 1 (g) was expected: is its scale "
            "off? recording.accelerometer_scale = 0.8 would mend that");
  EXPECT_EQ(describe(ImuStartReason(NoGravityInMotion{.gravity = 3.9})),
            "the motion and the accelerometer together make gravity 3.900000, neither 9.8 (m/s^2) "
            "nor 1 (g): is the IMU mounted otherwise than stated?");
  EXPECT_EQ(describe(ImuStartReason(GravityUnclear{.sigma = 0.0612})),
            "gravity's direction is known to 0.061200 rad only; more or longer motion is needed");
}

TEST(InertialText, Hindrances) {
  EXPECT_EQ(text_of(InertialHindrance(NoReadings{})), "there are no IMU readings");
  EXPECT_EQ(text_of(InertialHindrance(GapTooLong{.gap = 0.98765, .limit = 0.15})),
            "no IMU readings for 0.988 s, longer than 0.15 s (imu.max_gap)");
  EXPECT_EQ(text_of(InertialHindrance(
                StuckAxis{.gyroscope = false, .axis = 0, .value = 1.25, .duration = 0.5})),
            "the accelerometer's x stays at 1.25 for 0.5 s while its other axes move");
  EXPECT_EQ(text_of(InertialHindrance(UnitChanged{})),
            "the readings look as if their unit or sign had changed since the last start");
  EXPECT_EQ(text_of(InertialHindrance(SignUnclear{})),
            "the motion does not tell yet whether the accelerometer's sign is the opposite one");
  EXPECT_EQ(text_of(InertialHindrance(ImuStartReason(TooFewPoses{.poses = 4, .needed = 6}))),
            "4 poses; a start in motion needs 6 over half a second");
}

TEST(InertialText, ReadingsThatAreMissingOrStuck) {
  EXPECT_EQ(text_of(InertialCause(NoReadings{})), "there are no IMU readings");
  EXPECT_EQ(text_of(InertialCause(GapTooLong{.gap = 1.0, .limit = 0.15})),
            "no IMU readings for 1 s, longer than 0.15 s (imu.max_gap)");
  EXPECT_EQ(text_of(InertialCause(
                StuckAxis{.gyroscope = true, .axis = 2, .value = 0.0, .duration = 0.5})),
            "the gyroscope's z stays at 0 for 0.5 s while its other axes move: is it broken? Check "
            "it with adit inspect");
}

TEST(InertialText, StatesThatCannotBe) {
  const auto failed = [](const FailedCheck& one) {
    return text_of(InertialCause(CheckFailed{.check = one, .losses = 1}));
  };
  EXPECT_EQ(failed(ImpossibleState{.quantity = StateQuantity::prediction}),
            "what the readings say of the motion is not finite");
  EXPECT_EQ(failed(ImpossibleState{.quantity = StateQuantity::state}),
            "the fused state is not finite");
  EXPECT_EQ(failed(ImpossibleState{.quantity = StateQuantity::acceleration, .value = 123.4}),
            "the readings say that the sweep before was left with 123 m/s^2 on average, which "
            "nothing that carries a sensor does");
  EXPECT_EQ(failed(ImpossibleState{.quantity = StateQuantity::speed, .value = 101.0}),
            "the fused velocity is 101 m/s");
  EXPECT_EQ(
      failed(ImpossibleState{.quantity = StateQuantity::distance, .value = 50.0, .elapsed = 0.1}),
      "the fused position moved 50 m in 0.1 s");
  EXPECT_EQ(failed(ImpossibleState{.quantity = StateQuantity::gyro_bias, .value = 0.4}),
            "the gyroscope's bias would be 0.4 rad/s: is it saturated, in degrees, or mounted "
            "otherwise than imu.T_imu_lidar says?");
  EXPECT_EQ(failed(ImpossibleState{.quantity = StateQuantity::accel_bias, .value = 3.5}),
            "the accelerometer's bias would be 3.5 m/s^2: is its unit another, or imu.T_imu_lidar "
            "wrong?");
  EXPECT_EQ(failed(StateUndetermined{}),
            "the readings and the sweeps do not determine the fused state");
  EXPECT_EQ(failed(NotAligned{.duration = 3.1}), "no sweep could be aligned for 3.1 s");
}

TEST(InertialText, AlignmentsThatContradictAskWhatElseExplainsThem) {
  const auto failed = [](bool timed, bool assumed) {
    return CheckFailed{
        .check = AlignmentsContradict{.alignments = 3, .timed = timed, .sign_assumed = assumed}};
  };
  const std::string bare = "3 alignments in a row are where the IMU says that they cannot be";
  EXPECT_EQ(text_of(InertialCause(failed(true, false))),
            bare + ": are clock and imu.T_imu_lidar right?");
  EXPECT_EQ(text_of(InertialCause(failed(false, false))),
            bare +
                ": the sweeps have no times per point, so motion distorts them; else, are clock "
                "and imu.T_imu_lidar right?");
  EXPECT_EQ(text_of(InertialCause(failed(true, true))),
            bare +
                ": are clock and imu.T_imu_lidar right? And the accelerometer's sign, which "
                "the start could not tell from a sensor upside down?");
  EXPECT_EQ(explained(failed(true, true), GapBridged{}),
            bare +
                "; readings were missing shortly before, and what they would have said was "
                "guessed");
  EXPECT_EQ(
      explained(failed(true, true), Saturation{.gyroscope = true, .readings = 2, .limit = 1.5}),
      bare +
          "; the gyroscope is saturated: 2 readings stand at 1.5 rad/s, the end of its "
          "range");
}

TEST(InertialText, ASensorLostTooOften) {
  EXPECT_EQ(text_of(InertialCause(
                CheckFailed{.check = NotAligned{.duration = 3.1}, .losses = 5, .refused = true})),
            "no sweep could be aligned for 3.1 s; lost 5 times, so it is not used any more: check "
            "its mounting (imu.T_imu_lidar), its clock and its units with adit inspect");
}

TEST(InertialText, FaultsOfAGyroscope) {
  EXPECT_EQ(describe(check(GyroFault::none)), "");
  EXPECT_EQ(describe(check(GyroFault::constant)),
            "the gyroscope stays as it is while the sweeps turn over 30 sweeps: is it broken, or a "
            "message filled in?");
  EXPECT_EQ(describe(check(GyroFault::unrelated)),
            "the gyroscope's turns have little to do with those of the sweeps over 30 sweeps: is "
            "it of another recording, its clock off by more than 0.3 s, or saturated?");
  GyroCheck unit = check(GyroFault::unit);
  unit.factor = 57.2;
  EXPECT_EQ(describe(unit),
            "the gyroscope turns 57.2 times as much as the sweeps: it is in degrees a second "
            "(recording.gyroscope_scale = 0.0174533)");
  unit.factor = 0.25;
  EXPECT_EQ(describe(unit),
            "the gyroscope turns 0.250 times as much as the sweeps: is its unit another "
            "(recording.gyroscope_scale)?");
  EXPECT_EQ(describe(check(GyroFault::scale)),
            "the gyroscope turns 1.100 (+- 0.010) times as much as the sweeps, over 30 of them: "
            "its scale is off; recording.gyroscope_scale = 0.909 would mend that");
  EXPECT_EQ(describe(check(GyroFault::mounting)),
            "the gyroscope turns as the sweeps do, but about axes that are 90.0 degrees off (over "
            "30 sweeps): it is mounted otherwise than imu.T_imu_lidar says, whose rotation should "
            "be qx 0.0000, qy 0.0000, qz 0.7071, qw 0.7071");
}

TEST(InertialText, TheRemedyOfAClockIsTheWholeSetting) {
  GyroCheck late = check(GyroFault::clock);
  EXPECT_EQ(describe(late),
            "the gyroscope turns as the sweeps do, but 100 ms later (+- 4 ms, over 30 sweeps): its "
            "clock is late; recording.imu_time_offset = -0.100 would mend that from the start");
  late.configured_offset = 0.25;
  late.comparison->offset = -0.1004;
  EXPECT_EQ(describe(late),
            "the gyroscope turns as the sweeps do, but 100 ms earlier (+- 4 ms, over 30 sweeps): "
            "its clock is early; recording.imu_time_offset = 0.350 (not 0.250) would mend that "
            "from the start");
}

TEST(InertialText, WhatFollowsFromThem) {
  const GyroCheck constant = check(GyroFault::constant);
  EXPECT_EQ(text_of(InertialCause(GyroscopeDisagrees{.check = constant})),
            describe(constant) + "; the lidar goes alone until that is clear");
  EXPECT_EQ(text_of(InertialCause(GyroscopeDisagrees{.check = constant, .refused = true})),
            describe(constant) + "; it is not used any more");
  EXPECT_EQ(text_of(InertialCause(PredictsWorse{.better = 7, .sweeps = 30})),
            "corrected as the sweeps' turns say, it still predicts their turns worse than constant "
            "velocity (better in 7 of 30); it is not used any more");
}

TEST(InertialText, Corrections) {
  const GyroCheck clock = check(GyroFault::clock);
  EXPECT_EQ(text_of(InertialCause(SensorCorrected{.check = clock, .clock = 0.1004})),
            describe(clock) +
                "; its clock is corrected by -100.4 ms, as the sweeps' turns say; "
                "starting anew");
  GyroCheck refined = check(GyroFault::none);
  EXPECT_EQ(text_of(InertialCause(SensorCorrected{.check = refined, .turned = 0.05})),
            "its mounting is turned by 2.86 degrees, as the sweeps' turns say; starting anew");
  refined.comparison->mounting_sigma = {kInfinity, 0.01, kInfinity};
  EXPECT_EQ(names_of_unobserved_axes(*refined.comparison), "roll, yaw");
  EXPECT_EQ(
      text_of(InertialCause(SensorCorrected{.check = refined, .clock = -0.03, .turned = 0.05})),
      "its clock is corrected by 30.0 ms, its mounting is turned by 2.86 degrees (the motion does "
      "not tell roll, yaw), as the sweeps' turns say; starting anew");
}

}  // namespace
}  // namespace adit
