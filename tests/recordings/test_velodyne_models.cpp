// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Points of VLP-32C, VLS-128 and Puck Hi-Res: where and when the manuals say.
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/tests/recordings/packet_support.hpp"
#include "adit/tests/recordings/sensor_support.hpp"
#include "adit/tools/packets/velodyne_models.hpp"
#include "adit/tools/packets/velodyne_packets.hpp"

namespace adit {
namespace {

using test::Bytes;

constexpr Nanoseconds kHour{1'699'999'200'000'000'000};

Datagram datagram(const Bytes& bytes) {
  return {.received = kHour + std::chrono::seconds(1), .payload = bytes};
}

double azimuth_of(const Point& p) {
  return std::fmod(
      std::atan2(-static_cast<double>(p.y), static_cast<double>(p.x)) / kDegree + 360.0, 360.0);
}
double range_of(const Point& p) {
  return std::hypot(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
}

/// Each point against azimuth, elevation and time of its laser; the reflectivity names the laser.
void expect_points(const Sweep& sweep, const VelodyneModel& model, double first, double step,
                   Nanoseconds begin) {
  std::size_t sequence = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const Point& p = sweep.points[i];
    const auto laser = static_cast<std::size_t>(p.intensity);
    sequence += laser < last ? 1 : 0;
    last = laser;
    const double turned = step * model.firing.at(laser) / model.cycle;
    const double azimuth =
        first + step * static_cast<double>(sequence) + model.azimuth.at(laser) + turned;
    EXPECT_NEAR(azimuth_of(p), std::fmod(azimuth + 360.0, 360.0), 1e-3) << laser;
    const double level = std::hypot(static_cast<double>(p.x), static_cast<double>(p.y));
    const double height = static_cast<double>(p.z) - model.height.at(laser);
    EXPECT_NEAR(std::atan2(height, level) / kDegree, model.elevation.at(laser), 1e-3) << laser;
    const double time = seconds(sweep.stamp - begin) + static_cast<double>(sweep.times[i]);
    EXPECT_NEAR(time, static_cast<double>(sequence) * model.cycle + model.firing.at(laser), 2e-9);
    EXPECT_EQ(sweep.rings[i], model.rings.at(laser));
  }
}

TEST(VelodyneModels, AnglesAndTimesAreThoseOfTheManuals) {
  const VelodyneModel& vlp32 = *find_velodyne_model(0x28);
  EXPECT_EQ(vlp32.elevation.at(0), -25.0);
  EXPECT_EQ(vlp32.azimuth.at(0), 1.4);
  EXPECT_EQ(vlp32.azimuth.at(1), -4.2);
  EXPECT_EQ(vlp32.elevation.at(29), 15.0);
  EXPECT_EQ(vlp32.rings.at(0), 0);
  EXPECT_EQ(vlp32.rings.at(29), 31);
  EXPECT_DOUBLE_EQ(vlp32.firing.at(31), 15 * 2.304e-6) << "two lasers fire at a time";
  const VelodyneModel& vls128 = *find_velodyne_model(0xa1);
  EXPECT_EQ(vls128.elevation.at(36), -25.0);
  EXPECT_EQ(vls128.elevation.at(59), 15.0);
  EXPECT_EQ(vls128.azimuth.at(0), 6.354);
  EXPECT_EQ(vls128.azimuth.at(127), -6.354);
  EXPECT_DOUBLE_EQ(vls128.firing.at(63), 7 * 2.665e-6) << "eight lasers fire at a time";
  EXPECT_DOUBLE_EQ(vls128.firing.at(64), 9 * 2.665e-6) << "there is a break after half of them";
  EXPECT_EQ(find_velodyne_model(0x24)->elevation.at(15), 10.0);
  EXPECT_NEAR(vlp32.height.at(0), 0.0424 * std::tan(25.0 * kDegree), 1e-9);
  EXPECT_NEAR(vls128.height.at(59), -0.05863 * std::tan(15.0 * kDegree), 1e-9);
  EXPECT_EQ(find_velodyne_model(0x63), nullptr);
}

TEST(VelodyneModels, Vlp32PointsSingleAndDual) {
  const VelodyneModel& model = *find_velodyne_model(0x28);
  for (const bool dual : {false, true}) {
    const Bytes packet = test::velodyne_packet(
        100.0, 0.2, 5000, dual ? 0x39 : 0x37, 0x28, [&](std::size_t block, std::size_t laser) {
          // Of every other laser the second return is the first once more.
          return 2500 + laser + (dual && block % 2 == 1 && laser % 2 == 0 ? 500 : 0);
        });
    VelodyneSweeps sweeps;
    EXPECT_TRUE(sweeps.take(datagram(packet)).empty());
    const Sweep sweep = sweeps.finish().value();
    ASSERT_EQ(sweep.points.size(), dual ? 6U * 48U : 12U * 32U);
    EXPECT_EQ(sweep.stamp, kHour + std::chrono::microseconds(5000));
    EXPECT_NEAR(range_of(sweep.points[5]), 0.004 * 2505, 1e-4) << "steps of 4 mm, level";
    if (!dual) {
      expect_points(sweep, model, 100.0, 0.2, kHour + std::chrono::microseconds(5000));
    } else {
      EXPECT_NEAR(range_of(sweep.points[32]), 0.004 * 3000, 1e-2);
      EXPECT_EQ(sweep.times[32], 0.0F) << "a second return is of the same firing";
      EXPECT_NEAR(sweep.times[48], model.cycle, 1e-9);
    }
  }
}

TEST(VelodyneModels, Vls128PointsSingleAndDual) {
  const VelodyneModel& model = *find_velodyne_model(0xa1);
  const Nanoseconds begin = kHour + std::chrono::microseconds(5000) - Nanoseconds(8700);
  VelodyneSweeps single;
  const Bytes three = test::vls128_packet(
      200.0, 0.19, 5000, false,
      [](auto sequence, auto laser, auto) { return 2500 + 100 * sequence + laser; });
  EXPECT_TRUE(single.take(datagram(three)).empty());
  const Sweep sweep = single.finish().value();
  ASSERT_EQ(sweep.points.size(), 3U * 128U);
  EXPECT_EQ(sweep.stamp, begin) << "the manual takes 8.7 us off a packet's time";
  EXPECT_NEAR(range_of(sweep.points[128 + 83]), 0.004 * (2500 + 100 + 83), 1e-4) << "level";
  expect_points(sweep, model, 200.0, 0.19, begin);

  VelodyneSweeps dual;
  for (uint32_t i = 0; i < 3; ++i) {  // a packet each 53.3 us
    const Bytes one = test::vls128_packet(200.0 + 0.19 * i, 0.19, 5000 + 53 * i, true,
                                          [](auto, std::size_t laser, auto second) {
                                            return 2500 + (second == 1 && laser % 4 == 0 ? 100 : 0);
                                          });
    EXPECT_TRUE(dual.take(datagram(one)).empty());
  }
  const Sweep two = dual.finish().value();
  ASSERT_EQ(two.points.size(), 3U * (128U + 32U));
  // The last packet's laser 127 fires 16 groups after the azimuth of its block was read.
  const double turned = 0.19 * 16 * 2.665 / 53.3;
  EXPECT_NEAR(azimuth_of(two.points[3 * 160 - 9]), 200.38 + turned - 6.354, 2e-3);
  EXPECT_NEAR(two.times[3 * 160 - 9], 106e-6 + 16 * 2.665e-6, 1e-8);
}

TEST(VelodyneModels, SweepsBeginAtAzimuthZero) {
  for (const unsigned model : {0x24U, 0x28U, 0xa1U}) {
    VelodyneSweeps sweeps;
    std::vector<Sweep> whole;
    for (int i = 0; i < 100; ++i) {
      const double first = std::fmod(10.0 * i, 360.0);
      const auto micros = static_cast<uint32_t>(2700 * i);
      const Bytes packet = model == 0xa1 ? test::vls128_packet(first, 0.19, micros, false,
                                                               [](auto, auto, auto) { return 500; })
                                         : test::velodyne_packet(first, 0.2, micros, 0x37,
                                                                 static_cast<uint8_t>(model),
                                                                 [](auto, auto) { return 500; });
      for (Sweep& sweep : sweeps.take(datagram(packet))) {
        whole.push_back(std::move(sweep));
      }
    }
    ASSERT_EQ(whole.size(), 2U) << model;
    EXPECT_EQ(whole[1].points.size(), 36U * 12U * 32U) << model;
  }
}

TEST(VelodyneModels, BlocksThatWereNotWrittenAreLeftOut) {
  Bytes packet = test::vls128_packet(10.0, 0.2, 1, false, [](auto, auto, auto) { return 100; });
  for (std::size_t block = 3; block < 12; ++block) {
    test::put(packet, 100 * block, uint16_t{0});
  }
  VelodyneSweeps sweeps;
  sweeps.take(datagram(packet));
  EXPECT_EQ(sweeps.finish().value().points.size(), 3U * 32U);
}

}  // namespace
}  // namespace adit
