// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/saturation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include <gtest/gtest.h>

namespace adit {
namespace {

constexpr Nanoseconds kReadingPeriod = std::chrono::milliseconds(5);

// A swing of 3 rad/s about x, other axes moving as well; cut at the end of the range.
ImuSample swing(int i, double range) {
  const double phase = 0.02 * i;
  ImuSample sample;
  sample.stamp = i * kReadingPeriod;
  sample.angular_velocity = {std::clamp(3.0 * std::sin(phase), -range, range),
                             0.1 * std::cos(phase), 0.2 * std::sin(1.3 * phase)};
  sample.linear_acceleration = {0.01 * std::sin(3.0 * phase), 0.02 * std::cos(phase), 9.8};
  return sample;
}

SaturationWatch watched(int readings, double range) {
  SaturationWatch watch;
  for (int i = 0; i < readings; ++i) {
    watch.add(swing(i, range));
  }
  return watch;
}

TEST(SaturationWatch, TellsReadingsAtTheEndOfTheRange) {
  const SaturationWatch watch = watched(300, 2.0);
  long at_the_end = 0;
  for (int i = 0; i < 300; ++i) {
    at_the_end += std::abs(swing(i, 2.0).angular_velocity.x()) == 2.0 ? 1 : 0;
  }
  EXPECT_EQ(std::ssize(watch.of_gyroscope()), at_the_end);
  EXPECT_TRUE(std::ranges::is_sorted(watch.of_gyroscope()));
  const auto found = watch.between(Nanoseconds(-1), 300 * kReadingPeriod);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->gyroscope);
  EXPECT_EQ(found->readings, static_cast<std::size_t>(at_the_end));
  EXPECT_EQ(found->limit, 2.0);
  EXPECT_FALSE(watch.between(Nanoseconds(-1), 10 * kReadingPeriod)) << "none in the first 50 ms";
}

TEST(SaturationWatch, SaysNothingOfASwingWithinTheRange) {
  EXPECT_TRUE(watched(300, 4.0).of_gyroscope().empty());
}

TEST(SaturationWatch, MessagesThatComeAgainAreNone) {
  SaturationWatch watch;
  for (int i = 0; i < 79; ++i) {
    watch.add(swing(i, 4.0));
  }
  ImuSample again = swing(79, 4.0);  // the greatest of all
  for (int k = 0; k < 5; ++k) {
    watch.add(again);
    again.stamp += kReadingPeriod;
  }
  EXPECT_TRUE(watch.of_gyroscope().empty());
}

TEST(SaturationWatch, AGreaterReadingShowsThatItWasNone) {
  SaturationWatch watch = watched(300, 2.0);
  ASSERT_FALSE(watch.of_gyroscope().empty());
  watch.add(swing(393, 4.0));
  EXPECT_TRUE(watch.of_gyroscope().empty());
}

TEST(SaturationWatch, ForgetsAndMovesWithTheClock) {
  SaturationWatch watch = watched(300, 2.0);
  const Nanoseconds last = watch.of_gyroscope().back();
  watch.shift(kReadingPeriod);
  EXPECT_EQ(watch.of_gyroscope().back(), last + kReadingPeriod);
  watch.forget_before(last + kReadingPeriod);
  EXPECT_EQ(std::ssize(watch.of_gyroscope()), 1);
}

}  // namespace
}  // namespace adit
