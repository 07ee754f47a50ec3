// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/inertial_readings.hpp"

#include <cmath>
#include <variant>

#include <gtest/gtest.h>

#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

ImuInterval interval(double held_before, double longest_gap, double held_after) {
  ImuInterval result;
  result.samples.resize(2);
  result.held_before = held_before;
  result.longest_gap = longest_gap;
  result.held_after = held_after;
  return result;
}

TEST(CoverageFault, AGapIsBridgedBetweenItsEnds) {
  EXPECT_FALSE(coverage_fault(interval(0.0, 0.15, 0.0), 0.15));
  const auto fault = coverage_fault(interval(0.0, 0.151, 0.0), 0.15);
  ASSERT_TRUE(fault && std::holds_alternative<GapTooLong>(*fault));
  EXPECT_EQ(std::get<GapTooLong>(*fault).gap, 0.151);
  EXPECT_EQ(std::get<GapTooLong>(*fault).limit, 0.15);
}

TEST(CoverageFault, WithOneEndOnlyLessIsTooLong) {
  EXPECT_FALSE(coverage_fault(interval(0.05, 0.0, 0.05), 0.15));
  EXPECT_TRUE(coverage_fault(interval(0.051, 0.0, 0.0), 0.15));
  const auto fault = coverage_fault(interval(0.0, 0.01, 0.06), 0.15);
  ASSERT_TRUE(fault && std::holds_alternative<GapTooLong>(*fault));
  EXPECT_EQ(std::get<GapTooLong>(*fault).gap, 0.06);
  EXPECT_TRUE(coverage_fault(interval(0.03, 0.0, 0.0), 0.02)) << "and never more than may be";
}

TEST(CoverageFault, NothingIsNoReadings) {
  const auto fault = coverage_fault({}, 0.15);
  ASSERT_TRUE(fault);
  EXPECT_TRUE(std::holds_alternative<NoReadings>(*fault));
}

/// At 200 Hz; the gyroscope's x ends at 2 rad/s.
ImuSample swing(int i) {
  const double phase = 0.02 * i;
  return {.stamp = test::at_seconds(0.005 * i),
          .angular_velocity = {std::min(3.0 * std::sin(phase), 2.0), 0.1 * std::cos(phase),
                               0.2 * std::sin(1.3 * phase)},
          .linear_acceleration = {0.01 * std::sin(3.0 * phase), 0.02 * std::cos(phase), 9.8}};
}

InertialReadings swung(int count) {
  InertialReadings readings{ImuConfig{}};
  for (int i = 0; i < count; ++i) {
    readings.add(swing(i));
  }
  return readings;
}

TEST(InertialReadings, AClockThatIsCorrectedMovesAllThatIsKept) {
  InertialReadings readings = swung(150);
  const Nanoseconds newest = readings.newest().value();
  const auto saturated = readings.saturated_gyroscope();
  ASSERT_FALSE(saturated.empty());
  readings.correct_clock(0.1);
  EXPECT_EQ(readings.clock_offset(), 0.1);
  EXPECT_EQ(readings.newest(), newest - test::at_seconds(0.1));
  EXPECT_EQ(readings.saturated_gyroscope(), saturated) << "as they came";
  readings.correct_clock(0.04);
  EXPECT_EQ(readings.newest(), newest - test::at_seconds(0.04));
  readings.add(swing(150));
  EXPECT_EQ(readings.newest(), swing(150).stamp - test::at_seconds(0.04));
}

TEST(InertialReadings, SaturationIsToldWhenItBegins) {
  const InertialReadings readings = swung(150);
  const Nanoseconds first = readings.saturated_gyroscope().front();
  const Nanoseconds apart = test::at_seconds(0.1);
  EXPECT_FALSE(readings.saturation_begins(first - 2 * apart, first - apart));
  const auto begins = readings.saturation_begins(first - apart, first + apart);
  ASSERT_TRUE(begins);
  EXPECT_EQ(begins->limit, 2.0);
  EXPECT_FALSE(readings.saturation_begins(first + apart, first + 2 * apart)) << "it goes on";
  EXPECT_TRUE(readings.recent_saturation());
}

}  // namespace
}  // namespace adit
