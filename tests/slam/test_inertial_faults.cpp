// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What can be wrong with an inertial sensor: each fault is survived, and reported by its name.
#include <array>
#include <functional>
#include <numbers>
#include <ostream>

#include "adit/tests/slam/tracker_runs.hpp"

namespace adit {
namespace {

using test::each;
using test::kSweep;
using test::Outcome;
using test::run_tracker;
using test::tracker_config;
using test::without;

struct Case {
  const char* name;
  test::Fault fault;
  std::function<void(const Outcome&)> told;  ///< looks at what happened
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

/// It was started in motion, with such an accelerometer.
std::function<void(const Outcome&)> started(bool in_g = false, bool negative = false) {
  return [=](const Outcome& outcome) {
    const auto starts = outcome.starts<StartedInMotion>();
    ASSERT_FALSE(starts.empty());
    EXPECT_EQ(starts[0].in_g, in_g);
    EXPECT_EQ(starts[0].negative, negative);
  };
}

void told_as_gap(const Outcome& outcome) {
  const auto gaps = outcome.all<GapTooLong>();
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_NEAR(gaps[0].gap, kSweep, 0.006) << "by the next sweep";
  EXPECT_LT(gaps[0].limit, gaps[0].gap) << "an end of the gap is missing: less than max_gap";
}

/// The gyroscope was found wrong, by the lidar alone once more, and refused.
std::function<void(const Outcome&)> refused_for(GyroFault fault) {
  return [=](const Outcome& outcome) {
    const auto found = outcome.all<GyroscopeDisagrees>();
    ASSERT_EQ(found.size(), 2U);
    EXPECT_FALSE(found[0].refused);
    EXPECT_TRUE(found[1].refused);
    for (const GyroscopeDisagrees& one : found) {
      EXPECT_EQ(one.check.fault, fault) << to_string(one.check.fault);
      EXPECT_GE(one.check.turns, 20U);
    }
  };
}

/// Its clock was found late by so many seconds, and corrected within `error`.
std::function<void(const Outcome&)> clock_corrected(double late, double error = 0.003) {
  return [=](const Outcome& outcome) {
    const auto done = outcome.all<SensorCorrected>();
    ASSERT_FALSE(done.empty());
    EXPECT_EQ(done[0].check.fault, GyroFault::clock) << to_string(done[0].check.fault);
    ASSERT_TRUE(done[0].check.comparison && done[0].clock);
    EXPECT_NEAR(done[0].check.comparison->offset, late, error);
    EXPECT_EQ(*done[0].clock, done[0].check.comparison->offset);
  };
}

/// Its mounting was found turned by so many radians, and corrected.
std::function<void(const Outcome&)> mounting_corrected(double turned) {
  return [=](const Outcome& outcome) {
    const auto done = outcome.all<SensorCorrected>();
    ASSERT_FALSE(done.empty());
    EXPECT_EQ(done[0].check.fault, GyroFault::mounting) << to_string(done[0].check.fault);
    ASSERT_TRUE(done[0].check.comparison && done[0].turned);
    EXPECT_NEAR(done[0].check.comparison->misalignment, turned, 0.02);
    EXPECT_NEAR(*done[0].turned, turned, 0.02);
  };
}

/// Readings stand at the end of a range.
std::function<void(const Outcome&)> saturated(bool gyroscope, double limit) {
  return [=](const Outcome& outcome) {
    const auto found = outcome.saturations();
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found[0].gyroscope, gyroscope);
    EXPECT_EQ(found[0].limit, limit);
    EXPECT_GE(found[0].readings, 1U);
  };
}

std::vector<Case> cases() {
  const auto refused = InertialState::refused;
  const auto fused = InertialState::fused;
  const double degrees = 180.0 / std::numbers::pi;
  return {
      {"nothing", [](auto&) {}, started()},
      {"a gap of 10 ms", without(5.0, 5.011), started()},
      {"a gap of 1 s", without(5.0, 6.0),
       [](const Outcome& outcome) {
         told_as_gap(outcome);
         EXPECT_EQ(outcome.starts<StartedAfterGap>().size(), 1U);
       }},
      {"starts late", without(-1.0, 3.0), started()},
      {"ends early", without(8.0, 100.0), told_as_gap, InertialState::lost},
      {"accelerometer in g",
       each([](ImuSample& sample) { sample.linear_acceleration /= kStandardGravity; }),
       started(true)},
      {"accelerometer's sign", each([](ImuSample& sample) { sample.linear_acceleration *= -1.0; }),
       started(false, true)},
      {"constant", each([](ImuSample& sample) {
         sample.angular_velocity.setZero();
         sample.linear_acceleration = {0.0, 0.0, kStandardGravity};
       }),
       refused_for(GyroFault::constant), refused, 0.15},
      {"gyroscope in degrees", each([=](ImuSample& sample) { sample.angular_velocity *= degrees; }),
       [=](const Outcome& outcome) {
         refused_for(GyroFault::unit)(outcome);
         EXPECT_NEAR(outcome.all<GyroscopeDisagrees>().front().check.factor, degrees, 2.0);
       },
       refused, 0.15},
      {"clock late by 100 ms", clock_off(0.1), clock_corrected(0.1), fused, 0.06, 6.0},
      {"clock early by 100 ms", clock_off(-0.1), clock_corrected(-0.1), fused, 0.06, 6.0},
      {"clock late by 50 ms", clock_off(0.05), clock_corrected(0.05), fused, 0.06, 6.0},
      {"upside down", turned({0.0, 1.0, 0.0, 0.0}), mounting_corrected(std::numbers::pi), fused,
       0.06, 6.0},
      {"turned by a quarter", turned({std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)}),
       mounting_corrected(0.5 * std::numbers::pi), fused, 0.06, 6.0},
      {"gyroscope at the end of its range", clipped(1.5, 1000.0), saturated(true, 1.5), fused,
       0.03},
      {"accelerometer at the end of its range", clipped(1000.0, 12.5), saturated(false, 12.5),
       fused, 0.03},
      {"another motion's", each([](ImuSample& sample) {
         const double t = std::chrono::duration<double>(sample.stamp).count();
         sample.angular_velocity = {std::sin(31.0 * t), std::cos(27.0 * t), std::sin(5.3 * t)};
       }),
       refused_for(GyroFault::unrelated), refused, 0.15},
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
  one.told(outcome);
  EXPECT_FALSE(HasFailure()) << outcome.events();
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
  const auto at_rest = outcome.starts<StartedAtRest>();
  ASSERT_FALSE(at_rest.empty()) << outcome.events();
  EXPECT_NEAR(at_rest[0].duration, 1.0, 1e-6);
  const auto failed = outcome.all<CheckFailed>();
  ASSERT_FALSE(failed.empty()) << outcome.events();
  const auto* contradiction = std::get_if<AlignmentsContradict>(&failed[0].check);
  ASSERT_NE(contradiction, nullptr) << outcome.events();
  EXPECT_EQ(contradiction->alignments, 3);
  EXPECT_TRUE(contradiction->timed && contradiction->sign_assumed);
  EXPECT_FALSE(failed[0].refused);
  EXPECT_EQ(failed[0].losses, 1);
  const auto in_motion = outcome.starts<StartedInMotion>();
  ASSERT_FALSE(in_motion.empty()) << outcome.events();
  EXPECT_TRUE(in_motion.back().negative);
  EXPECT_GT(in_motion.back().usual_error, 2.0);
  EXPECT_EQ(outcome.reports.back().accel_scale, -1.0) << outcome.events();
  EXPECT_EQ(outcome.reports.back().state, InertialState::fused) << outcome.events();
  EXPECT_LE(outcome.error_after(10.0), 0.06) << outcome.events();
}

TEST(InertialFaults, ASaturatedGyroscopeNeitherMovesTheClockNorIsRefused) {
  const Outcome outcome = run_tracker(clipped(1.0, 1000.0), 40.0);
  const auto found = outcome.saturations();
  ASSERT_FALSE(found.empty()) << outcome.events();
  EXPECT_TRUE(found[0].gyroscope);
  for (const InertialReport& report : outcome.reports) {
    ASSERT_NE(report.state, InertialState::refused) << outcome.events();
    ASSERT_FALSE(report.comparison) << outcome.events();
    ASSERT_EQ(report.clock_offset, 0.0) << outcome.events();
    ASSERT_LE(mounting_error(report), 1e-9) << outcome.events();
  }
}

/// A cart: it turns about z alone.
test::WavyMotion planar_motion() {
  return {.position = {{{0.0, 0.0, 0.0, 2.0}, {0.5, 0.2, 0.0, 0.0}, {}}},
          .angles = {{{}, {}, {0.5, 0.3, 0.0, 0.1}}}};
}

// The sweeps contradict it before half a second has told that the axis is stuck.
TEST(InertialFaults, AnAxisThatIsStuckWhileNoOtherTurnsIsWaitedFor) {
  const Outcome outcome = run_tracker(each([](ImuSample& sample) {
                                        const double t = seconds(sample.stamp);
                                        if (t > 5.0 && t < 12.0) {
                                          sample.angular_velocity.z() = 0.0;
                                        }
                                      }),
                                      20.0, tracker_config(), planar_motion());
  EXPECT_EQ(outcome.state_at(4.9), InertialState::fused) << outcome.events();
  EXPECT_EQ(outcome.state_at(11.9), InertialState::lost) << outcome.events();
  const auto& hindrance = outcome.reports[119].hindrance;
  ASSERT_TRUE(hindrance) << outcome.events();
  const auto* stuck = std::get_if<StuckAxis>(&*hindrance);
  ASSERT_NE(stuck, nullptr) << outcome.events();
  EXPECT_TRUE(stuck->gyroscope);
  EXPECT_EQ(stuck->axis, 2);
  EXPECT_EQ(outcome.reports.back().state, InertialState::fused) << outcome.events();
  EXPECT_TRUE(outcome.all<SensorCorrected>().empty()) << outcome.events();
  EXPECT_TRUE(outcome.all<GyroscopeDisagrees>().empty()) << outcome.events();
}

// What stays so is no reason to wait for ever, nor to start again and again.
TEST(InertialFaults, AnAxisThatStaysStuckIsRefusedInTheEnd) {
  const Outcome outcome = run_tracker(each([](ImuSample& sample) {
                                        if (seconds(sample.stamp) > 5.0) {
                                          sample.angular_velocity.z() = 0.0;
                                        }
                                      }),
                                      200.0, tracker_config(), planar_motion());
  EXPECT_EQ(outcome.reports.back().state, InertialState::refused) << outcome.events();
  EXPECT_LE(outcome.starts<StartedInMotion>().size(), 6U) << outcome.events();
}

TEST(Saturation, OneReadingIsToldAsOne) {
  SaturationWatch watch;
  for (int i = 0; i < 10; ++i) {
    watch.add({.stamp = test::at_seconds(i),
               .angular_velocity = {i < 4 ? 0.1 * i : 2.0, 0.01 * i, 0.0},
               .linear_acceleration = {0.0, 0.0, kStandardGravity}});
  }
  const auto one = watch.between(test::at_seconds(6), test::at_seconds(7));
  ASSERT_TRUE(one);
  EXPECT_TRUE(one->gyroscope);
  EXPECT_EQ(one->readings, 1U);
  EXPECT_EQ(one->limit, 2.0);
  const auto two = watch.between(test::at_seconds(6), test::at_seconds(8));
  ASSERT_TRUE(two);
  EXPECT_EQ(two->readings, 2U);
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
  EXPECT_EQ(unobserved_axes(*last.comparison), (std::array{false, false, false}));
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
  EXPECT_EQ(check->fault, GyroFault::none) << to_string(check->fault);
  EXPECT_EQ(unobserved_axes(*check->comparison), (std::array{false, false, true}));
}

}  // namespace
}  // namespace adit
