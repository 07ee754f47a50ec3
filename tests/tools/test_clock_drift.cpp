// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/clock_drift.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

/// 100 Hz; delay(t) in s, with a jitter of 1 ms.
TopicStatistics topic(const std::function<double(double)>& delay, double seconds = 60.0) {
  TopicStatistics statistics;
  Random random(7);
  for (int i = 0; i < static_cast<int>(100.0 * seconds); ++i) {
    const double t = 0.01 * i;
    const double late = delay(t) + random.uniform(0.0, 1e-3);
    statistics.timeline.add(Nanoseconds(static_cast<int64_t>(1e9 * (t + late))),
                            one_event(0.01, late));
  }
  return statistics;
}

std::vector<Finding> compare(const TopicStatistics& sweeps, const TopicStatistics& imu) {
  return find_clock_drift(
      {{"/points", "", TopicKind::sweeps, {}}, {"/imu", "", TopicKind::imu, {}}}, {sweeps, imu}, 0);
}

double steady(double) {
  return 0.1;
}

TEST(ClockDrift, RatesAreToldToAFewPartsInAMillion) {
  const auto trend = clock_trend(topic([](double t) { return 0.05 - 2e-4 * t; }).timeline);
  ASSERT_TRUE(trend.has_value());
  EXPECT_NEAR(trend->rate, 2e-4, 2e-6);
  EXPECT_LT(trend->sigma, 1e-6);
}

TEST(ClockDrift, ClocksThatDriftApartAreNamed) {
  const auto findings = compare(topic(steady), topic([](double t) { return 0.05 + 3e-4 * t; }));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].kind, "clock_drift");
  EXPECT_EQ(findings[0].topic, "/imu");
  EXPECT_NE(findings[0].found.find("ppm slower than that of /points"), std::string::npos)
      << findings[0].found;
}

TEST(ClockDrift, NothingIsNamedWhereThereIsNone) {
  const TopicStatistics sweeps = topic(steady);
  EXPECT_TRUE(compare(sweeps, topic(steady)).empty());
  // Both against the recorder's clock alone.
  const auto drifting = [](double t) { return 0.1 + 1e-3 * t; };
  EXPECT_TRUE(compare(topic(drifting), topic(drifting)).empty());
  // A queue that fills at the end, a step, a leap and a short recording.
  EXPECT_TRUE(
      compare(sweeps, topic([](double t) { return t < 40.0 ? 0.01 : 0.01 + 2e-3 * (t - 40.0); }))
          .empty());
  EXPECT_TRUE(compare(sweeps, topic([](double t) { return t < 30.0 ? 0.01 : 0.06; })).empty());
  EXPECT_TRUE(compare(sweeps, topic([](double t) { return t < 30.0 ? 0.01 : 37.01; })).empty());
  EXPECT_TRUE(
      compare(topic(steady, 10.0), topic([](double t) { return 0.05 + 3e-4 * t; }, 10.0)).empty());
}

// A channel that was announced and never written to, and recordings of a moment.
TEST(ClockDrift, TooFewMessagesTellNothing) {
  EXPECT_FALSE(clock_trend({}).has_value());
  for (const double seconds : {0.0, 0.01, 0.1}) {
    EXPECT_FALSE(clock_trend(topic(steady, seconds).timeline).has_value()) << seconds;
    EXPECT_TRUE(compare(topic(steady), topic(steady, seconds)).empty()) << seconds;
    EXPECT_TRUE(compare(topic(steady, seconds), topic(steady)).empty()) << seconds;
  }
}

}  // namespace
}  // namespace adit
