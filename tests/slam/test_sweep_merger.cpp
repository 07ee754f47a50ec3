// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/sweep_merger.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace adit {
namespace {

using std::chrono::milliseconds;

/// A sensor whose points say who measured them (x), the how many-th they are (y) and when (z, s).
struct Rotor {
  float name = 0.0F;
  Nanoseconds period = milliseconds(100);
  Nanoseconds phase{0};
  int points = 50;
  bool timed = true;

  Sweep sweep(int index) const {
    Sweep sweep;
    sweep.stamp = phase + index * period;
    for (int i = 0; i < points; ++i) {
      const double time = timed ? seconds(period) * i / points : 0.0;
      sweep.points.push_back({name, static_cast<float>(index * points + i),
                              static_cast<float>(seconds(sweep.stamp) + time), 0.0F});
      if (timed) {
        sweep.times.push_back(static_cast<float>(time));
      }
    }
    return sweep;
  }
};

/// What has come out, and whether each point has the time at which it was measured.
struct Collected {
  std::vector<Sweep> sweeps;
  std::map<std::pair<float, float>, int> times_seen;  ///< by sensor and number

  void take(SweepMerger& merger) {
    while (auto sweep = merger.next()) {
      ASSERT_EQ(sweep->points.size(), sweep->times.size());
      for (std::size_t i = 0; i < sweep->points.size(); ++i) {
        const Point& point = sweep->points[i];
        EXPECT_NEAR(seconds(sweep->stamp) + static_cast<double>(sweep->times[i]), point.z, 1e-5);
        EXPECT_GE(sweep->times[i], 0.0F);
        ++times_seen[{point.x, point.y}];
      }
      EXPECT_TRUE(sweeps.empty() || sweep->stamp > sweeps.back().stamp);
      sweeps.push_back(std::move(*sweep));
    }
  }

  /// Points of a sensor, each of which was seen once.
  int points_of(float name) const {
    int points = 0;
    for (const auto& [point, times] : times_seen) {
      EXPECT_EQ(times, 1) << "point " << point.second << " of sensor " << point.first;
      points += point.first == name ? 1 : 0;
    }
    return points;
  }
};

/// That see as far as numbers of points go.
std::vector<MergedSensor> sensors(std::size_t count) {
  return std::vector<MergedSensor>(count, MergedSensor{.c_max = 1e6});
}

TEST(SweepMerger, EachPointGoesByItsTimeIntoOneSweep) {
  const Rotor front{.name = 1.0F};
  const Rotor rear{.name = 2.0F, .period = milliseconds(50), .phase = milliseconds(37)};
  SweepMerger merger(sensors(2));
  Collected out;
  for (int i = 0; i < 20; ++i) {
    merger.add(0, front.sweep(i));
    merger.add(1, rear.sweep(2 * i));
    merger.add(1, rear.sweep(2 * i + 1));
    out.take(merger);
  }
  EXPECT_GE(out.sweeps.size(), 18U) << "sweeps wait for what belongs to them, and no longer";
  merger.flush();
  out.take(merger);
  EXPECT_EQ(out.points_of(1.0F), 20 * front.points);
  EXPECT_EQ(out.points_of(2.0F), 40 * rear.points);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(out.sweeps[i].stamp, milliseconds(100 * i));
    EXPECT_LE(duration_of(out.sweeps[i]), 0.1001);
  }
  EXPECT_EQ(merger.counts()[1].sweeps, 40U);
  EXPECT_EQ(merger.counts()[1].late_points, 0U);
}

TEST(SweepMerger, PointsAreMovedIntoTheFirstSensorsAxes) {
  std::vector<MergedSensor> two = sensors(2);
  two[1].T_lidar_sensor.translate(Eigen::Vector3d(0.0, 0.0, 1.0));
  two[1].T_lidar_sensor.rotate(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  two[1].c_min = 1.0;
  two[1].c_max = 10.0;
  SweepMerger merger(two);
  Sweep first;
  first.points = {{5.0F, 0.0F, 0.0F, 7.0F}};
  first.rings = {3};
  first.doppler = {0.5F};
  Sweep second;
  const float none = std::numeric_limits<float>::quiet_NaN();
  second.points = {{2.0F, 0.0F, 0.0F, 9.0F},
                   {0.5F, 0.0F, 0.0F, 0.0F},
                   {20.0F, 0.0F, 0.0F, 0.0F},
                   {none, none, none, 0.0F}};
  second.doppler = {1.0F, 1.0F, 1.0F, 1.0F};
  merger.add(0, first);
  merger.add(1, second);
  merger.flush();
  const auto merged = merger.next();
  ASSERT_TRUE(merged);
  ASSERT_EQ(merged->points.size(), 5U);
  EXPECT_EQ(merged->points[0].x, 5.0F);
  EXPECT_NEAR(merged->points[1].x, 0.0, 1e-6);
  EXPECT_NEAR(merged->points[1].y, 2.0, 1e-6);
  EXPECT_NEAR(merged->points[1].z, 1.0, 1e-6);
  EXPECT_EQ(merged->points[1].intensity, 9.0F);
  for (std::size_t i = 2; i < 5; ++i) {
    EXPECT_EQ(merged->points[i].x, 0.0F) << "no return: out of the sensor's own range";
    EXPECT_EQ(merged->points[i].z, 0.0F);
  }
  EXPECT_EQ(merged->rings, (std::vector<uint16_t>{3, 0, 0, 0, 0}));
  ASSERT_EQ(merged->doppler.size(), 5U);
  EXPECT_EQ(merged->doppler[0], 0.5F);
  EXPECT_TRUE(std::isnan(merged->doppler[1])) << "it is along the ray from another sensor";
  EXPECT_FALSE(merger.next());
}

TEST(SweepMerger, ASensorThatFailsOrStartsLateStopsNobody) {
  const Rotor front{.name = 1.0F};
  const Rotor rear{.name = 2.0F, .phase = milliseconds(20)};
  const Rotor left{.name = 3.0F, .phase = milliseconds(70)};
  SweepMerger merger(sensors(3));
  Collected out;
  for (int i = 0; i < 60; ++i) {
    merger.add(0, front.sweep(i));
    if (i < 30) {
      merger.add(1, rear.sweep(i));
    }
    if (i >= 20) {
      merger.add(2, left.sweep(i));
    }
    out.take(merger);
    EXPECT_GE(static_cast<int>(out.sweeps.size()) + 5, i) << "nothing waits for what is not there";
  }
  merger.flush();
  out.take(merger);
  EXPECT_EQ(out.points_of(1.0F), 60 * front.points);
  EXPECT_EQ(out.points_of(2.0F), 30 * rear.points);
  EXPECT_EQ(out.points_of(3.0F), 40 * left.points);
}

TEST(SweepMerger, WhereTheFirstFailsAnotherTakesItsPlace) {
  const Rotor front{.name = 1.0F};
  const Rotor rear{.name = 2.0F, .period = milliseconds(125), .phase = milliseconds(30)};
  SweepMerger merger(sensors(2));
  Collected out;
  for (int i = 0; i < 60; ++i) {
    if (i < 20 || i >= 40) {
      merger.add(0, front.sweep(i));
    }
    if (i % 5 < 4) {  // as they arrive: four in half a second
      merger.add(1, rear.sweep(i / 5 * 4 + i % 5));
    }
    out.take(merger);
  }
  merger.flush();
  out.take(merger);
  EXPECT_EQ(out.points_of(1.0F), 40 * front.points);
  EXPECT_EQ(out.points_of(2.0F), 48 * rear.points);
  EXPECT_NEAR(static_cast<double>(out.sweeps.size()), 20 + 32, 2.0);
}

TEST(SweepMerger, SweepsOfOneMomentAreMatchedThoughTheirStampsJitter) {
  const Rotor front{.name = 1.0F, .timed = false};
  const Rotor rear{.name = 2.0F, .phase = milliseconds(40), .timed = false};
  SweepMerger merger(sensors(2));
  Collected out;
  for (int i = 0; i < 30; ++i) {
    const auto with_jitter = [&](const Rotor& rotor, int jitter) {
      Sweep sweep = rotor.sweep(i);
      sweep.stamp += milliseconds(jitter);
      for (Point& point : sweep.points) {
        point.z = static_cast<float>(seconds(sweep.stamp));
      }
      return sweep;
    };
    merger.add(0, with_jitter(front, (i * 7) % 11 - 5));
    merger.add(1, with_jitter(rear, (i * 5) % 9 - 4));
    out.take(merger);
  }
  merger.flush();
  out.take(merger);
  EXPECT_EQ(out.points_of(1.0F), 30 * front.points);
  EXPECT_EQ(out.points_of(2.0F), 30 * rear.points);
  EXPECT_EQ(out.sweeps.size(), 30U);
  for (const Sweep& sweep : out.sweeps) {
    EXPECT_EQ(sweep.points.size(), 100U) << "one of each sensor";
  }
}

TEST(SweepMerger, TheSameArrivalsGiveTheSameBytes) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto run = [&] {
      std::mt19937 random(seed);
      SweepMerger merger(sensors(3));
      std::vector<Sweep> sweeps;
      for (int i = 0; i < 100; ++i) {
        const auto sensor = random() % 3U;
        const Rotor rotor{.name = static_cast<float>(sensor),
                          .period = milliseconds(40 + 30 * sensor),
                          .timed = sensor != 1};
        if (random() % 20 == 0) {
          merger.flush();
        }
        // Lost, late and repeated ones, and leaps of a second.
        merger.add(sensor, rotor.sweep(i / 2 + static_cast<int>(random() % 20) / 19 * 25));
        while (auto sweep = merger.next()) {
          EXPECT_TRUE(sweeps.empty() || sweep->stamp > sweeps.back().stamp);
          sweeps.push_back(std::move(*sweep));
        }
      }
      return sweeps;
    };
    const std::vector<Sweep> once = run();
    const std::vector<Sweep> again = run();
    ASSERT_EQ(once.size(), again.size());
    EXPECT_GT(once.size(), 2U);
    for (std::size_t i = 0; i < once.size(); ++i) {
      EXPECT_EQ(once[i].stamp, again[i].stamp);
      EXPECT_EQ(once[i].times, again[i].times);
      EXPECT_TRUE(std::ranges::equal(
          once[i].points, again[i].points,
          [](const auto& a, const auto& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }));
    }
  }
}

TEST(SweepMerger, StampsThatGoBackwardsAndTimesThatNoSweepHasHoldNothingBack) {
  SweepMerger merger(sensors(2));
  std::size_t out = 0;
  for (int i = 0; i < 500; ++i) {
    Sweep sweep = Rotor{}.sweep(1000 - i);
    sweep.times[0] = 1e30F;
    sweep.times[1] = std::numeric_limits<float>::quiet_NaN();
    merger.add(0, sweep);
    while (merger.next()) {
      ++out;
    }
  }
  EXPECT_GE(out, 1U) << "the other sensor never comes, and these do not wait for it";
  merger.flush();
  while (merger.next()) {
    ++out;
  }
  EXPECT_LE(out, 500U);
}

TEST(SweepMerger, NoSensorIsRefused) {
  EXPECT_THROW(SweepMerger({}), std::invalid_argument);
  SweepMerger one(sensors(1));
  EXPECT_FALSE(one.next());
  one.flush();
  EXPECT_FALSE(one.next());
  EXPECT_THROW(one.add(1, Sweep{}), std::out_of_range);
}

}  // namespace
}  // namespace adit
