// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/executor/sensor_feed.hpp"

#include <algorithm>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace adit {
namespace {

using std::chrono::milliseconds;

int ms(Nanoseconds stamp) {
  return static_cast<int>(stamp / milliseconds(1));
}

Sweep sweep(int begin_ms) {
  Sweep value;
  value.stamp = milliseconds(begin_ms);
  value.points = {{1.0F, 2.0F, 3.0F, 0.0F}, {1.0F, 2.0F, 3.0F, 0.0F}};
  value.times = {0.0F, 0.09375F};
  return value;
}

ImuSample reading(int time_ms) {
  return {.stamp = milliseconds(time_ms)};
}

/// Readings every 10 ms of the times that `there` keeps; sweeps of 100 ms that arrive at their end.
std::vector<Measurement> drive(int sweeps, const std::function<bool(int)>& there) {
  std::vector<Measurement> arrivals;
  for (int time = 0; time <= 100 * sweeps + 50; time += 10) {
    if (time > 0 && time % 100 == 0 && time <= 100 * sweeps) {
      arrivals.emplace_back(sweep(time - 100));
    }
    if (there(time)) {
      arrivals.emplace_back(reading(time));
    }
  }
  return arrivals;
}

/// What comes out: stamps of readings as they are, of sweeps with 0.5 added, ms.
std::vector<double> fed(SensorFeed& feed, const std::vector<Measurement>& arrivals) {
  std::vector<double> order;
  const auto drain = [&] {
    while (const auto next = feed.next()) {
      order.push_back(ms(stamp_of(*next)) + (std::holds_alternative<Sweep>(*next) ? 0.5 : 0.0));
    }
  };
  for (const Measurement& arrival : arrivals) {
    feed.add(arrival);
    drain();
  }
  feed.flush();
  drain();
  return order;
}

/// Each sweep's begin with the newest reading before it, ms.
std::vector<std::pair<int, int>> sweeps_fed(const std::vector<Measurement>& arrivals) {
  SensorFeed feed(true);
  std::vector<std::pair<int, int>> result;
  int newest = -1;
  for (const double stamp : fed(feed, arrivals)) {
    const int whole = static_cast<int>(stamp);
    if (stamp == whole) {
      newest = whole;
    } else {
      result.emplace_back(whole, newest);
    }
  }
  return result;
}

using Fed = std::vector<std::pair<int, int>>;

TEST(SensorFeed, ASweepComesOnceTheReadingsCoverIt) {
  EXPECT_EQ(sweeps_fed(drive(4, [](int) { return true; })),
            (Fed{{0, 100}, {100, 200}, {200, 300}, {300, 400}}));
}

TEST(SensorFeed, WithoutAnInertialSensorSweepsComeAtOnce) {
  SensorFeed feed(false);
  for (const int begin : {0, 100, 50}) {
    feed.add(sweep(begin));
    const auto next = feed.next();
    ASSERT_TRUE(next);
    EXPECT_EQ(ms(stamp_of(*next)), begin);
    EXPECT_FALSE(feed.next());
  }
}

TEST(SensorFeed, AnImuThatStopsHoldsNoSweepForLong) {
  const Fed result = sweeps_fed(drive(12, [](int time) { return time <= 250; }));
  ASSERT_EQ(result.size(), 12U);
  EXPECT_EQ(result[1], (std::pair<int, int>{100, 200}));
  for (std::size_t i = 2; i < result.size(); ++i) {
    EXPECT_EQ(result[i], (std::pair<int, int>{100 * static_cast<int>(i), 250}));
  }
}

TEST(SensorFeed, ASweepWithoutReadingsWaitsForThreeTenthsOfASecond) {
  SensorFeed feed(true);
  feed.add(reading(0));
  int arrived = 0;
  for (std::optional<Measurement> next; !next || !std::holds_alternative<Sweep>(*next);) {
    ASSERT_LT(arrived, 3000);
    feed.add(sweep(arrived));
    next = feed.next();
    if (next && !std::holds_alternative<Sweep>(*next)) {
      next = feed.next();
    }
    arrived += 100;
  }
  // The first ends after 94 ms; half a second is the window in which stamps are put in order.
  EXPECT_GE(arrived - 100, 94 + 300 + 500);
  EXPECT_LE(arrived - 100, 94 + 300 + 500 + 100);
}

TEST(SensorFeed, AnyOrderOfArrivalWithinTheWindowGivesTheSameOrder) {
  const std::vector<Measurement> arrivals = drive(20, [](int) { return true; });
  SensorFeed straight(true);
  const std::vector<double> expected = fed(straight, arrivals);
  ASSERT_EQ(expected.size(), arrivals.size());
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    std::vector<Measurement> shuffled = arrivals;
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < shuffled.size(); i += 20) {
      std::shuffle(shuffled.begin() + static_cast<long>(i),
                   shuffled.begin() + static_cast<long>(std::min(i + 20, shuffled.size())), random);
    }
    SensorFeed feed(true);
    EXPECT_EQ(fed(feed, shuffled), expected) << "seed " << seed;
  }
}

TEST(SensorFeed, LaterThanTheWindowComesAtOnceAndIsNotLost) {
  SensorFeed feed(true);
  EXPECT_EQ(fed(feed, {reading(0), reading(600), reading(1200), reading(50), reading(1900)}),
            (std::vector<double>{0.0, 600.0, 50.0, 1200.0, 1900.0}));
}

TEST(SensorFeed, AfterAFlushItGoesOn) {
  SensorFeed feed(true);
  EXPECT_EQ(fed(feed, {sweep(0), reading(20)}), (std::vector<double>{20.0, 0.5}));
  EXPECT_EQ(fed(feed, {reading(200), sweep(100), reading(210)}),
            (std::vector<double>{200.0, 100.5, 210.0}));
}

TEST(SensorFeed, HoldsNoMoreThanMemoryAllowsWhereAClockStandsStill) {
  SensorFeed feed(true);
  Sweep large = sweep(7);
  large.points.resize(std::size_t{10} << 16U);  // 10 MiB
  std::size_t added = 0;
  while (!feed.next() && added < 100) {
    feed.add(large);
    feed.add(reading(7));
    ++added;
  }
  EXPECT_LE(added, 27U);
}

TEST(SensorFeed, FixesComeInTheirPlace) {
  SensorFeed feed(true);
  GnssFix fix;
  fix.stamp = milliseconds(20);
  EXPECT_EQ(fed(feed, {reading(30), fix, reading(10)}), (std::vector<double>{10.0, 20.0, 30.0}));
}

}  // namespace
}  // namespace adit
