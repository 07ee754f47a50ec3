// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include <gtest/gtest.h>

#include "adit/slam/inertial/imu_buffer.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

/// Reads its time in seconds on each axis of both sensors.
ImuSample clock_sample(int time_ms) {
  const Eigen::Vector3d value = Eigen::Vector3d::Constant(1e-3 * time_ms);
  return {milliseconds(time_ms), value, value};
}

ImuBuffer buffer_of(std::initializer_list<int> times_ms) {
  ImuBuffer buffer;
  for (const int time : times_ms) {
    buffer.push(clock_sample(time));
  }
  return buffer;
}

std::vector<double> times_of(const ImuInterval& interval) {
  std::vector<double> times;
  for (const ImuSample& sample : interval.samples) {
    times.push_back(std::chrono::duration<double, std::milli>(sample.stamp).count());
  }
  return times;
}

TEST(ImuBuffer, AnIntervalEndsExactlyWhereAskedWithInterpolatedReadings) {
  const ImuBuffer buffer = buffer_of({0, 10, 20, 30, 40});
  const ImuInterval interval = buffer.between(milliseconds(14), milliseconds(33));
  EXPECT_EQ(times_of(interval), (std::vector<double>{14, 20, 30, 33}));
  for (const ImuSample& sample : interval.samples) {
    const double time = std::chrono::duration<double>(sample.stamp).count();
    EXPECT_NEAR(sample.angular_velocity.x(), time, 1e-15);
    EXPECT_NEAR(sample.linear_acceleration.z(), time, 1e-15);
  }
  EXPECT_EQ(interval.held_before, 0.0);
  EXPECT_EQ(interval.held_after, 0.0);
  EXPECT_NEAR(interval.longest_gap, 0.010, 1e-12);
}

TEST(ImuBuffer, EndsOnReadingsAreNotDoubled) {
  const ImuBuffer buffer = buffer_of({0, 10, 20, 30, 40});
  EXPECT_EQ(times_of(buffer.between(milliseconds(10), milliseconds(30))),
            (std::vector<double>{10, 20, 30}));
}

TEST(ImuBuffer, WhereItDoesNotReachTheNearestReadingIsHeldAndSaidToBe) {
  const ImuBuffer buffer = buffer_of({20, 30});
  const ImuInterval interval = buffer.between(milliseconds(5), milliseconds(48));
  EXPECT_EQ(times_of(interval), (std::vector<double>{5, 20, 30, 48}));
  EXPECT_NEAR(interval.held_before, 0.015, 1e-12);
  EXPECT_NEAR(interval.held_after, 0.018, 1e-12);
  EXPECT_EQ(interval.samples.front().angular_velocity.x(), 0.020);
  EXPECT_EQ(interval.samples.back().angular_velocity.x(), 0.030);

  const ImuInterval after = buffer.between(milliseconds(100), milliseconds(150));
  EXPECT_EQ(times_of(after), (std::vector<double>{100, 150}));
  EXPECT_NEAR(after.held_after, 0.050, 1e-12);
  EXPECT_EQ(after.held_before, 0.0);
  const ImuInterval before = buffer.between(milliseconds(0), milliseconds(10));
  EXPECT_NEAR(before.held_before, 0.010, 1e-12);
  EXPECT_EQ(before.held_after, 0.0);
}

TEST(ImuBuffer, AGapIsFoundEvenIfTheIntervalBeginsAndEndsInsideIt) {
  const ImuBuffer buffer = buffer_of({0, 10, 200, 210});
  EXPECT_NEAR(buffer.between(milliseconds(0), milliseconds(210)).longest_gap, 0.190, 1e-12);
  EXPECT_NEAR(buffer.between(milliseconds(50), milliseconds(60)).longest_gap, 0.190, 1e-12);
  EXPECT_NEAR(buffer.between(milliseconds(0), milliseconds(10)).longest_gap, 0.010, 1e-12);
}

TEST(ImuBuffer, NothingComesOfNothing) {
  EXPECT_TRUE(ImuBuffer().between(milliseconds(0), milliseconds(10)).samples.empty());
  const ImuBuffer buffer = buffer_of({0, 10});
  EXPECT_TRUE(buffer.between(milliseconds(5), milliseconds(5)).samples.empty());
  EXPECT_TRUE(buffer.between(milliseconds(7), milliseconds(5)).samples.empty());
}

TEST(ImuBuffer, LateSamplesArePutInPlaceAndRepeatedOnesDropped) {
  ImuBuffer buffer = buffer_of({0, 10, 30});
  EXPECT_EQ(buffer.push(clock_sample(20)), ImuArrival::inserted);
  EXPECT_EQ(buffer.push(clock_sample(20)), ImuArrival::duplicate);
  EXPECT_EQ(buffer.push(clock_sample(30)), ImuArrival::duplicate);
  EXPECT_EQ(buffer.push(clock_sample(-10)), ImuArrival::too_late);
  EXPECT_EQ(buffer.push(clock_sample(40)), ImuArrival::appended);
  EXPECT_EQ(times_of(buffer.between(milliseconds(0), milliseconds(40))),
            (std::vector<double>{0, 10, 20, 30, 40}));
}

TEST(ImuBuffer, AClockThatIsSetBackStartsItAnew) {
  ImuBuffer buffer = buffer_of({5000, 5010, 5020});
  EXPECT_EQ(buffer.push(clock_sample(10)), ImuArrival::restarted);
  EXPECT_EQ(buffer.push(clock_sample(20)), ImuArrival::appended);
  EXPECT_EQ(buffer.size(), 2U);
  EXPECT_EQ(buffer.front().stamp, milliseconds(10));
}

TEST(ImuBuffer, NumbersThatAreNoneAreDropped) {
  ImuBuffer buffer = buffer_of({0});
  ImuSample bad = clock_sample(10);
  bad.angular_velocity.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(buffer.push(bad), ImuArrival::not_finite);
  bad = clock_sample(10);
  bad.linear_acceleration.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(buffer.push(bad), ImuArrival::not_finite);
  EXPECT_EQ(buffer.size(), 1U);
}

TEST(ImuBuffer, ForgettingKeepsWhatALaterIntervalNeeds) {
  ImuBuffer buffer = buffer_of({0, 10, 20, 30, 40});
  buffer.forget_before(milliseconds(25));
  EXPECT_EQ(buffer.front().stamp, milliseconds(20));
  const ImuInterval interval = buffer.between(milliseconds(25), milliseconds(35));
  EXPECT_EQ(times_of(interval), (std::vector<double>{25, 30, 35}));
  EXPECT_EQ(interval.held_before, 0.0);
  buffer.forget_before(milliseconds(1000));
  EXPECT_EQ(buffer.size(), 1U);
}

}  // namespace
}  // namespace adit
