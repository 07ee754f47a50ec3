// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Sensors against what their manuals say.
#include "adit/tools/simulator/range_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

double elevation_of(const Firing& firing) {
  return std::asin(firing.direction.z()) / kDegree;
}
double azimuth_of(const Firing& firing) {
  return std::atan2(firing.direction.y(), firing.direction.x()) / kDegree;
}

TEST(RangeSensor, Vlp16FiresInTheOrderOfItsManual) {
  const std::vector<Firing> firings = firings_of(range_sensor_named("VLP-16"), 0);
  constexpr std::array kAngles{-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
  constexpr std::array kRings{0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15};
  for (std::size_t i = 0; i < 48; ++i) {
    EXPECT_NEAR(elevation_of(firings[i]), kAngles[i % 16], 1e-9);
    EXPECT_EQ(firings[i].ring, kRings[i % 16]);
    EXPECT_EQ(firings[i].time,
              static_cast<int64_t>(i / 16) * 55296 + static_cast<int64_t>(i % 16) * 2304);
  }
  EXPECT_NEAR(firings[0].origin.z(), 0.0112, 1e-4) << "the lowest beam has the highest origin";
  EXPECT_NEAR(static_cast<double>(firings.size()), 16.0 * 100e6 / 55296.0, 16.0);
}

TEST(RangeSensor, SpinningSensorsTurnClockwiseOnceASweep) {
  for (const char* name : {"VLP-16", "HDL-32E", "OS1-128"}) {
    const std::vector<Firing> firings = firings_of(range_sensor_named(name), 0);
    const std::size_t beams = std::string(name) == "VLP-16"    ? 16
                              : std::string(name) == "HDL-32E" ? 32
                                                               : 128;
    double turned = 0.0;
    double last = azimuth_of(firings[0]);
    for (std::size_t i = beams; i < firings.size(); i += beams) {
      const double azimuth = azimuth_of(firings[i]);
      double step = azimuth - last;
      step -= 360.0 * std::round(step / 360.0);
      EXPECT_LT(step, 0.0) << name;
      turned += step;
      last = azimuth;
    }
    EXPECT_NEAR(turned, -360.0, 0.5) << name;
  }
}

TEST(RangeSensor, FiringGoesOnAcrossSweeps) {
  const RangeSensor sensor = range_sensor_named("VLP-16");
  const std::vector<Firing> first = firings_of(sensor, 0);
  const std::vector<Firing> second = firings_of(sensor, 1);
  const int64_t gap = second[0].time + sensor.period - first[first.size() - 16].time;
  EXPECT_EQ(gap, 55296);
}

TEST(RangeSensor, Hdl32eHasItsThirtyTwoBeams) {
  const std::vector<Firing> firings = firings_of(range_sensor_named("HDL-32E"), 0);
  EXPECT_NEAR(elevation_of(firings[0]), -30.67, 0.01);
  EXPECT_NEAR(elevation_of(firings[1]), -9.33, 0.01);
  EXPECT_NEAR(elevation_of(firings[2]), -29.33, 0.01);
  EXPECT_NEAR(elevation_of(firings[30]), -10.67, 0.01);
  EXPECT_NEAR(elevation_of(firings[31]), 10.67, 0.01);
  EXPECT_EQ(firings[31].time, 31 * 1152);
  EXPECT_EQ(firings[32].time, 46080);
  EXPECT_EQ(firings[31].ring, 31);
  EXPECT_NEAR(10.0 * static_cast<double>(firings.size()), 695000.0, 2000.0) << "points a second";
}

TEST(RangeSensor, Hdl64eFiresItsBlocksTogether) {
  const std::vector<Firing> firings = firings_of(range_sensor_named("HDL-64E"), 0);
  for (std::size_t i = 0; i < 64; i += 2) {
    EXPECT_EQ(firings[i].time, firings[i + 1].time);
    EXPECT_LT(elevation_of(firings[i]), -8.8) << "the lower block";
    EXPECT_GT(elevation_of(firings[i + 1]), -8.4) << "the upper block";
  }
  EXPECT_EQ(firings[2].time, 728);
  std::set<uint16_t> rings;
  for (std::size_t i = 0; i < 64; ++i) {
    rings.insert(firings[i].ring);
  }
  EXPECT_EQ(rings.size(), 64U);
  EXPECT_NEAR(elevation_of(firings[1]), 2.0, 1e-9);
  EXPECT_NEAR(elevation_of(firings[62]), -24.33, 0.01);
  EXPECT_NEAR(10.0 * static_cast<double>(firings.size()), 1333333.0, 1000.0) << "points a second";
}

TEST(RangeSensor, OusterColumnsShareTheirTime) {
  for (const auto& [name, half_field] : {std::pair{"OS1-128", 22.5}, {"OS0-128", 45.0}}) {
    const std::vector<Firing> firings = firings_of(range_sensor_named(name), 3);
    ASSERT_EQ(firings.size(), 128U * 1024U);
    EXPECT_NEAR(elevation_of(firings[0]), half_field, 1e-9);
    EXPECT_NEAR(elevation_of(firings[127]), -half_field, 1e-9);
    for (std::size_t i = 0; i < 256; ++i) {
      EXPECT_EQ(firings[i].time, i < 128 ? 0 : 97656);
      EXPECT_EQ(firings[i].ring, i % 128);
    }
    EXPECT_EQ(firings.back().time, int64_t{1023} * 100000000 / 1024);
  }
}

/// Share of one-degree cells of the field of view that were looked at.
double covered(const RangeSensor& sensor, int sweeps) {
  std::set<std::pair<int, int>> cells;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (const Firing& firing : firings_of(sensor, sweep)) {
      cells.emplace(static_cast<int>(std::floor(azimuth_of(firing))),
                    static_cast<int>(std::floor(elevation_of(firing))));
    }
  }
  return static_cast<double>(cells.size());
}

TEST(RangeSensor, LivoxPatternsFillTheirFieldOfViewWithTime) {
  const RangeSensor mid = range_sensor_named("Mid-360");
  EXPECT_EQ(firings_of(mid, 0).size(), 20000U) << "200 000 points a second";
  const double field = 360.0 * 59.0;
  EXPECT_GT(covered(mid, 1), 0.3 * field);
  EXPECT_LT(covered(mid, 1), 0.75 * field);
  EXPECT_GT(covered(mid, 10), 0.95 * field);
  for (const Firing& firing : firings_of(mid, 5)) {
    EXPECT_GT(elevation_of(firing), -7.001);
    EXPECT_LT(elevation_of(firing), 52.001);
  }
  const RangeSensor avia = range_sensor_named("Avia");
  EXPECT_EQ(firings_of(avia, 0).size(), 24000U) << "240 000 points a second";
  EXPECT_GT(covered(avia, 10), 1.3 * covered(avia, 1));
  for (const Firing& firing : firings_of(avia, 5)) {
    EXPECT_LT(std::abs(azimuth_of(firing)), 35.2001);
    EXPECT_LT(std::abs(elevation_of(firing)), 38.6001);
  }
}

TEST(RangeSensor, ADepthCameraTakesAllPixelsAtOnce) {
  const std::vector<Firing> firings = firings_of(range_sensor_named("depth-camera"), 3);
  ASSERT_EQ(firings.size(), 424U * 240U);
  EXPECT_TRUE(std::ranges::all_of(firings, [](const Firing& one) { return one.time == 0; }));
  EXPECT_GT(firings.front().direction.y(), 0.0) << "the first pixel is on the left";
  EXPECT_GT(firings.front().direction.z(), 0.0) << "and above";
  const Firing& left = firings[120 * 424];
  const Firing& right = firings[120 * 424 + 423];
  EXPECT_NEAR(azimuth_of(left) - azimuth_of(right), 87.0, 0.3);
  EXPECT_EQ(left.ring, 120);
  EXPECT_NEAR(elevation_of(firings[212]) - elevation_of(firings[239 * 424 + 212]), 56.2, 0.6);
}

TEST(RangeSensor, TimesGrowAndDirectionsHaveUnitLength) {
  for (const std::string& name : range_sensor_names()) {
    const RangeSensor sensor = range_sensor_named(name);
    const std::vector<Firing> firings = firings_of(sensor, 2);
    int64_t last = 0;
    for (const Firing& firing : firings) {
      ASSERT_GE(firing.time, last) << name;
      ASSERT_LT(firing.time, sensor.period + 60000) << name;
      ASSERT_NEAR(firing.direction.norm(), 1.0, 1e-14) << name;
      last = firing.time;
    }
  }
  EXPECT_THROW(range_sensor_named("VLP16"), UsageError);
}

}  // namespace
}  // namespace adit
