// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/stuck_axis.hpp"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

/// Readings at 200 Hz of a sensor that turns, with its noise.
ImuSample turning(Random& random, int i) {
  ImuSample sample;
  sample.stamp = std::chrono::milliseconds(5 * i);
  const double t = 0.005 * i;
  sample.angular_velocity = {0.3 * std::sin(t), 0.2 * std::cos(2.0 * t), 0.1 * std::sin(3.0 * t)};
  sample.linear_acceleration = {0.8 * std::sin(2.0 * t), 0.7 * std::cos(3.0 * t), 9.8};
  for (int k = 0; k < 3; ++k) {
    sample.angular_velocity(k) += 0.002 * random.gaussian();
    sample.linear_acceleration(k) += 0.02 * random.gaussian();
  }
  return sample;
}

TEST(StuckAxis, ASensorThatWorksHasNone) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    StuckAxisWatch watch;
    for (int i = 0; i < 4000; ++i) {
      watch.add(turning(random, i));
      ASSERT_FALSE(watch.stuck()) << i;
    }
  }
}

TEST(StuckAxis, IsToldAfterHalfASecondAndUntilItMovesAgain) {
  for (int axis = 0; axis < 6; ++axis) {
    Random random(7);
    StuckAxisWatch watch;
    std::optional<int> first;
    for (int i = 0; i < 2000; ++i) {
      ImuSample sample = turning(random, i);
      if (i >= 400 && i < 1200) {
        (axis < 3 ? sample.angular_velocity : sample.linear_acceleration)(axis % 3) = 0.0;
      }
      watch.add(sample);
      first = watch.stuck() && !first ? std::optional(i) : first;
      EXPECT_FALSE(i >= 1200 && watch.stuck()) << i;
    }
    ASSERT_TRUE(first) << axis;
    EXPECT_GE(*first, 500);
    EXPECT_LE(*first, 800) << "as soon as the others have moved enough";
  }
}

TEST(StuckAxis, AtRestCoarseSensorsRepeatTheirValues) {
  Random random(3);
  StuckAxisWatch watch;
  for (int i = 0; i < 4000; ++i) {
    ImuSample sample;
    sample.stamp = std::chrono::milliseconds(5 * i);
    const auto coarse = [&](double step) { return step * std::round(random.gaussian()); };
    sample.angular_velocity = {i < 40 ? coarse(0.01) : 0.01, coarse(0.01), 0.0};
    sample.linear_acceleration = {i < 40 ? coarse(0.05) : 0.05, coarse(0.05), 9.8};
    watch.add(sample);
    ASSERT_FALSE(watch.stuck()) << i;
    ASSERT_FALSE(watch.unchanged()) << i;
  }
}

// A cart turns about z alone: its other axes have noise, and no motion.
TEST(StuckAxis, AnAxisWithoutItsNoiseMayBe) {
  Random random(5);
  StuckAxisWatch watch;
  for (int i = 0; i < 2000; ++i) {
    ImuSample sample;
    sample.stamp = std::chrono::milliseconds(5 * i);
    sample.angular_velocity = {0.002 * random.gaussian(), 0.002 * random.gaussian(),
                               0.3 * std::sin(0.005 * i)};
    sample.linear_acceleration = {0.02 * random.gaussian(), 0.02 * random.gaussian(), 9.8};
    if (i >= 400 && i < 1200) {
      sample.angular_velocity.z() = 0.0;
    }
    watch.add(sample);
    ASSERT_FALSE(watch.stuck()) << i;
    const auto unchanged = watch.unchanged();
    ASSERT_EQ(unchanged.has_value(), i >= 500 && i < 1200) << i;
    EXPECT_TRUE(!unchanged || (unchanged->gyroscope && unchanged->axis == 2)) << i;
    EXPECT_FALSE(watch.unchanged(std::chrono::milliseconds(1999))) << i;
    EXPECT_EQ(watch.unchanged(std::chrono::milliseconds(2000)).has_value(), unchanged.has_value());
  }
}

TEST(StuckAxis, AnAxisThatNeverReadAnythingElseIsOfAFlatWorld) {
  Random random(4);
  StuckAxisWatch watch;
  for (int i = 0; i < 1000; ++i) {
    ImuSample sample = turning(random, i);
    sample.angular_velocity.x() = sample.angular_velocity.y() = 0.0;
    watch.add(sample);
    ASSERT_FALSE(watch.stuck()) << i;
  }
}

TEST(StuckAxis, IsToldWithItsAxisValueAndTime) {
  Random random(7);
  StuckAxisWatch watch;
  for (int i = 0; i < 700; ++i) {
    ImuSample sample = turning(random, i);
    if (i >= 400) {
      sample.linear_acceleration.y() = 0.25;
    }
    watch.add(sample);
  }
  const auto stuck = watch.stuck();
  ASSERT_TRUE(stuck);
  EXPECT_FALSE(stuck->gyroscope);
  EXPECT_EQ(stuck->axis, 1);
  EXPECT_EQ(stuck->value, 0.25);
  EXPECT_NEAR(stuck->duration, 1.495, 1e-9);
}

}  // namespace
}  // namespace adit
