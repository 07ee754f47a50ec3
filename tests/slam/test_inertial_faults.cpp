// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What can be wrong with an inertial sensor: each fault is survived, and told by its name.
#include <numbers>
#include <ostream>

#include "adit/tests/slam/tracker_runs.hpp"

namespace adit {
namespace {

using test::each;
using test::Outcome;
using test::run_tracker;
using test::tracker_config;
using test::without;

struct Case {
  const char* name;
  test::Fault fault;
  std::vector<std::string> told;  ///< each is part of what was said
  InertialState last = InertialState::fused;
  double error = 0.06;  ///< m, at most
  double after = 0.0;   ///< s from the start, from when on that holds
};
std::ostream& operator<<(std::ostream& out, const Case& one) {
  return out << one.name;
}

test::Fault clock_off(double seconds) {
  return each([=](ImuSample& sample) { sample.stamp += test::at_seconds(seconds); });
}

test::Fault turned(const Eigen::Quaterniond& q) {
  return each([=](ImuSample& sample) {
    sample.angular_velocity = q * sample.angular_velocity;
    sample.linear_acceleration = q * sample.linear_acceleration;
  });
}

/// At the ends of these ranges (rad/s, m/s^2).
test::Fault clipped(double rate, double acceleration) {
  return each([=](ImuSample& sample) {
    sample.angular_velocity = sample.angular_velocity.cwiseMax(-rate).cwiseMin(rate);
    sample.linear_acceleration =
        sample.linear_acceleration.cwiseMax(-acceleration).cwiseMin(acceleration);
  });
}

std::vector<Case> cases() {
  const auto refused = InertialState::refused;
  const auto fused = InertialState::fused;
  const double degrees = 180.0 / std::numbers::pi;
  return {
      {"nothing", [](auto&) {}, {"started"}},
      {"a gap of 10 ms", without(5.0, 5.011), {"started"}},
      {"a gap of 1 s", without(5.0, 6.0), {"no IMU readings for", "readings are back"}},
      {"starts late", without(-1.0, 3.0), {"started"}},
      {"ends early", without(8.0, 100.0), {"no IMU readings"}, InertialState::lost},
      {"accelerometer in g",
       each([](ImuSample& sample) { sample.linear_acceleration /= kStandardGravity; }),
       {"in g"}},
      {"accelerometer's sign",
       each([](ImuSample& sample) { sample.linear_acceleration *= -1.0; }),
       {"opposite sign"}},
      {"constant",
       each([](ImuSample& sample) {
         sample.angular_velocity.setZero();
         sample.linear_acceleration = {0.0, 0.0, kStandardGravity};
       }),
       {"stays as it is while the sweeps turn"},
       refused,
       0.15},
      {"gyroscope in degrees",
       each([=](ImuSample& sample) { sample.angular_velocity *= degrees; }),
       {"in degrees a second", "gyroscope_scale = 0.0174533"},
       refused,
       0.15},
      {"clock late by 100 ms",
       clock_off(0.1),
       {"its clock is late", "imu_time_offset = -0.10", "its clock is corrected by -100"},
       fused,
       0.06,
       6.0},
      {"clock early by 100 ms",
       clock_off(-0.1),
       {"its clock is early", "imu_time_offset = 0.10", "its clock is corrected by 100"},
       fused,
       0.06,
       6.0},
      {"clock late by 50 ms", clock_off(0.05), {"its clock is late"}, fused, 0.06, 6.0},
      {"upside down",
       turned({0.0, 1.0, 0.0, 0.0}),
       {"about axes that are", "its mounting is turned by 1"},
       fused,
       0.06,
       6.0},
      {"turned by a quarter",
       turned({std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)}),
       {"about axes that are", "its mounting is turned by 90"},
       fused,
       0.06,
       6.0},
      {"gyroscope at the end of its range",
       clipped(1.5, 1000.0),
       {"the gyroscope is saturated", "stand at 1.5 rad/s"},
       fused,
       0.03},
      {"accelerometer at the end of its range",
       clipped(1000.0, 12.5),
       {"the accelerometer is saturated", "stand at 12.5"},
       fused,
       0.03},
      {"another motion's",
       each([](ImuSample& sample) {
         const double t = std::chrono::duration<double>(sample.stamp).count();
         sample.angular_velocity = {std::sin(31.0 * t), std::cos(27.0 * t), std::sin(5.3 * t)};
       }),
       {"have little to do with"},
       refused,
       0.15},
  };
}

double mounting_error(const InertialReport& report) {
  return rotation_angle(report.T_body_lidar.linear().transpose() * test::T_body_lidar().linear());
}

class InertialFault : public testing::TestWithParam<Case> {};

TEST_P(InertialFault, IsSurvivedAndToldByItsName) {
  const Case& one = GetParam();
  const Outcome outcome = run_tracker(one.fault);
  EXPECT_EQ(outcome.reports.back().state, one.last) << outcome.events();
  for (const std::string& part : one.told) {
    EXPECT_NE(outcome.events().find(part), std::string::npos) << "no '" << part << "' in:\n"
                                                              << outcome.events();
  }
  EXPECT_LE(outcome.error_after(one.after), one.error) << outcome.events();
}

INSTANTIATE_TEST_SUITE_P(All, InertialFault, testing::ValuesIn(cases()));

// At rest the opposite sign is a sensor upside down: until it moves.
TEST(InertialFaults, ASignThatAStartAtRestCannotTellIsToldByTheMotion) {
  test::WavyMotion motion = test::hand_held_motion();
  motion.rest = 2.0;
  const Outcome outcome =
      run_tracker(each([](ImuSample& sample) { sample.linear_acceleration *= -1.0; }), 14.0,
                  tracker_config(), motion);
  for (const char* part : {"at rest for 1 s", "cannot tell from a sensor upside down",
                           "of the opposite sign (the usual one leaves"}) {
    EXPECT_NE(outcome.events().find(part), std::string::npos) << part << "\n" << outcome.events();
  }
  EXPECT_EQ(outcome.reports.back().accel_scale, -1.0) << outcome.events();
  EXPECT_EQ(outcome.reports.back().state, InertialState::fused) << outcome.events();
  EXPECT_LE(outcome.error_after(10.0), 0.06) << outcome.events();
}

TEST(InertialFaults, ASaturatedGyroscopeNeitherMovesTheClockNorIsRefused) {
  const Outcome outcome = run_tracker(clipped(1.0, 1000.0), 40.0);
  EXPECT_NE(outcome.events().find("the gyroscope is saturated"), std::string::npos);
  for (const InertialReport& report : outcome.reports) {
    ASSERT_NE(report.state, InertialState::refused) << outcome.events();
    ASSERT_FALSE(report.comparison) << outcome.events();
    ASSERT_EQ(report.clock_offset, 0.0) << outcome.events();
    ASSERT_LE(mounting_error(report), 1e-9) << outcome.events();
  }
}

TEST(Saturation, OneReadingIsToldAsOne) {
  SaturationWatch watch;
  for (int i = 0; i < 10; ++i) {
    watch.add({.stamp = test::at_seconds(i),
               .angular_velocity = {i < 4 ? 0.1 * i : 2.0, 0.01 * i, 0.0},
               .linear_acceleration = {0.0, 0.0, kStandardGravity}});
  }
  const std::string one = watch.evidence(test::at_seconds(6), test::at_seconds(7));
  EXPECT_EQ(one, "the gyroscope is saturated: 1 reading stands at 2 rad/s, the end of its range");
  const std::string two = watch.evidence(test::at_seconds(6), test::at_seconds(8));
  EXPECT_NE(two.find("2 readings stand at 2 rad/s"), std::string::npos) << two;
}

ImuConfig refining() {
  ImuConfig config = tracker_config();
  config.refine_time_offset = true;
  config.refine_rotation = true;
  return config;
}

TEST(Refinement, AClockThatIs30MillisecondsOffIsCorrected) {
  for (const double offset : {0.03, -0.03}) {
    const Outcome outcome = run_tracker(clock_off(offset), 20.0, refining());
    const InertialReport& last = outcome.reports.back();
    EXPECT_EQ(last.state, InertialState::fused) << outcome.events();
    EXPECT_NEAR(last.clock_offset, offset, 0.003) << outcome.events();
    EXPECT_LE(outcome.error_after(10.0), 0.05) << outcome.events();
  }
}

TEST(Refinement, AMountingThatIsThreeDegreesOffIsCorrected) {
  ImuConfig config = refining();
  const Eigen::Quaterniond wrong(test::T_body_lidar().linear() *
                                 Eigen::AngleAxisd(3.0 * std::numbers::pi / 180.0,
                                                   Eigen::Vector3d(1.0, -1.0, 0.5).normalized()));
  (*config.T_imu_lidar)[3] = wrong.x();
  (*config.T_imu_lidar)[4] = wrong.y();
  (*config.T_imu_lidar)[5] = wrong.z();
  (*config.T_imu_lidar)[6] = wrong.w();
  const Outcome outcome = run_tracker([](auto&) {}, 20.0, config);
  EXPECT_NEAR(mounting_error(outcome.reports.front()), 0.0524, 0.001);
  EXPECT_LE(mounting_error(outcome.reports.back()), 0.015) << outcome.events();
  EXPECT_EQ(outcome.reports.back().state, InertialState::fused) << outcome.events();
}

TEST(Refinement, WhatIsRightStaysAsItIs) {
  const Outcome outcome = run_tracker([](auto&) {}, 20.0, refining());
  const InertialReport& last = outcome.reports.back();
  EXPECT_EQ(last.clock_offset, 0.0) << outcome.events();
  EXPECT_LE(mounting_error(last), 1e-9) << outcome.events();
  ASSERT_TRUE(last.comparison);
  EXPECT_EQ(unobserved_axes(*last.comparison), "");
  EXPECT_LE(std::abs(last.comparison->offset), 4.0 * last.comparison->offset_sigma + 0.001);
}

TEST(Refinement, AMotionInThePlaneDoesNotTellTheHeadingOfTheMounting) {
  const test::WavyMotion planar{.position = {{{0.0, 0.0, 0.0, 2.0}, {0.5, 0.2, 0.0, 0.0}, {}}},
                                .angles = {{{}, {}, {0.5, 0.3, 0.0, 0.1}}}};
  GyroMonitor monitor;
  for (const ImuSample& sample : test::readings(planar, -1.0, 6.5, test::kRate)) {
    monitor.add(sample);
  }
  std::optional<GyroCheck> check;
  for (int i = 0; i < 60; ++i) {
    const NavState state = planar.state(0.1 * i);
    monitor.add({state.stamp, state.T_map_body});
    const auto found = monitor.check({});
    check = found ? found : check;
  }
  ASSERT_TRUE(check && check->comparison);
  EXPECT_EQ(check->fault, GyroFault::none) << check->evidence;
  EXPECT_EQ(unobserved_axes(*check->comparison), "yaw");
}

}  // namespace
}  // namespace adit
