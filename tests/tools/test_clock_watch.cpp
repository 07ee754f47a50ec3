// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/topics/clock_watch.hpp"

#include <functional>

#include <gtest/gtest.h>

namespace adit {
namespace {

constexpr Nanoseconds kBegin = std::chrono::seconds(1'700'000'000);

/// 10 Hz for 10 s; by message: s that the stamp is ahead, and s that the message is late.
ClockWatch watch(
    const std::function<double(int)>& ahead,
    const std::function<double(int)>& late = [](int) { return 0.01; }) {
  ClockWatch clock;
  for (int i = 0; i < 100; ++i) {
    const Nanoseconds at = kBegin + nanoseconds(0.1 * i);
    clock.add(at + nanoseconds(late(i)), at + nanoseconds(ahead(i)));
  }
  return clock;
}

TEST(ClockWatch, ASteadyClockHasNoStepWhateverItsOffset) {
  for (const double offset : {0.0, 37.0, -1.6e9}) {
    const ClockWatch clock = watch([&](int) { return offset; });
    EXPECT_TRUE(clock.steps().empty());
    EXPECT_NEAR(clock.typical_delay(), 0.01 - offset, 1e-6);
    EXPECT_NEAR(clock.span(), 9.9, 1e-6);
  }
}

TEST(ClockWatch, ARestartIsAStepAndTheOffsetThatOfTheLongerPart) {
  const ClockWatch clock = watch([](int i) { return i < 60 ? 0.0 : -1.7e9; });
  const auto steps = clock.steps();
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_NEAR(steps[0].seconds, -1.7e9, 1e-3);
  EXPECT_NEAR(steps[0].after, 6.0, 1e-6);
  EXPECT_EQ(steps[0].stamp, std::chrono::seconds(6));
  EXPECT_NEAR(clock.typical_delay(), 0.01, 1e-6) << "no mean over the step";
  EXPECT_NEAR(clock.span(), 5.9 + 3.9, 1e-6);
}

TEST(ClockWatch, StepsForwardAndBackAreEachNamed) {
  const ClockWatch clock = watch([](int i) { return i < 30 ? 0.0 : i < 70 ? 37.0 : 0.0; });
  const auto steps = clock.steps();
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_NEAR(steps[0].seconds, 37.0, 1e-6);
  EXPECT_NEAR(steps[1].seconds, -37.0, 1e-6);
}

TEST(ClockWatch, AMessageWithAStrayStampIsNoStep) {
  for (const double stray : {-1.7e9, 40.0}) {
    const ClockWatch clock = watch([&](int i) { return i == 50 || i == 51 ? stray : 0.0; });
    EXPECT_TRUE(clock.steps().empty()) << stray;
    EXPECT_NEAR(clock.typical_delay(), 0.01, 1e-6) << stray;
  }
}

TEST(ClockWatch, MessagesThatWereHeldUpAndComeAtOnceAreNoStep) {
  // From 3 to 7 s nothing arrives; then all does, but for what the queue has dropped.
  const auto late = [](int i) { return i < 30 || i >= 70 ? 0.01 : 7.0 - 0.1 * i; };
  EXPECT_TRUE(watch([](int) { return 0.0; }, late).steps().empty());
  ClockWatch dropped;
  for (int i = 0; i < 100; ++i) {
    if (i < 40 || i >= 70) {
      dropped.add(kBegin + nanoseconds(0.1 * i + late(i)), kBegin + nanoseconds(0.1 * i));
    }
  }
  EXPECT_TRUE(dropped.steps().empty());
}

TEST(ClockWatch, ARecorderThatStampsAllAtOnceShowsNoStep) {
  ClockWatch clock;
  for (int i = 0; i < 20; ++i) {
    clock.add(kBegin, kBegin + std::chrono::seconds(2 * i));
  }
  EXPECT_TRUE(clock.steps().empty());
}

}  // namespace
}  // namespace adit
