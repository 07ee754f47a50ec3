// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Radial speeds of points in clouds.
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/point_files.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/recordings/ros_clouds.hpp"
#include "adit/tools/recordings/ros_codec.hpp"

namespace adit::ros {
namespace {

constexpr uint8_t kInt16 = 3;
constexpr uint8_t kFloat32 = 7;
constexpr uint8_t kFloat64 = 8;

/// Two points with a field of that name and type behind x, y and z.
template <class T>
CloudMessage cloud_with(const std::string& name, uint8_t type, T first, T second) {
  const std::string bytes = test::bytes_of_all(1.0F, 2.0F, 3.0F, first, 4.0F, 5.0F, 6.0F, second);
  const auto view = std::as_bytes(std::span(bytes));
  CloudMessage cloud;
  cloud.data.assign(view.begin(), view.end());
  cloud.message.width = 2;
  cloud.message.point_step = 12 + sizeof(T);
  cloud.message.row_step = 2 * cloud.message.point_step;
  cloud.message.fields = {
      {"x", 0, kFloat32, 1}, {"y", 4, kFloat32, 1}, {"z", 8, kFloat32, 1}, {name, 12, type, 1}};
  cloud.message.data = cloud.data;
  return cloud;
}

std::vector<float> doppler_in(const CloudMessage& cloud) {
  return to_sweep(cloud.message, Nanoseconds(1), "drive").sweep.doppler;
}

TEST(Doppler, IsKnownByTheNamesThatDriversGiveIt) {
  for (const char* name : {"doppler", "velocity", "v_doppler_mps", "doppler_velocity", "range_rate",
                           "radial_speed", "Doppler"}) {
    EXPECT_EQ(doppler_in(cloud_with(name, kFloat32, -1.5F, 0.25F)),
              (std::vector<float>{-1.5F, 0.25F}))
        << name;
    EXPECT_EQ(doppler_in(cloud_with(name, kFloat64, -1.5, 0.25)),
              (std::vector<float>{-1.5F, 0.25F}))
        << name;
  }
  EXPECT_TRUE(doppler_in(cloud_with("snr", kFloat32, 1.0F, 2.0F)).empty());
}

TEST(Doppler, OfIntegersOrOfThreeNumbersIsNotRead) {
  EXPECT_TRUE(doppler_in(cloud_with("doppler", kInt16, int16_t{-150}, int16_t{25})).empty());
  CloudMessage vectors = cloud_with("velocity", kFloat32, 1.0F, 2.0F);
  vectors.message.fields.back().count = 3;
  EXPECT_TRUE(doppler_in(vectors).empty());
}

TEST(Doppler, ThatIsNoNumberWasNotMeasured) {
  const std::vector<float> doppler =
      doppler_in(cloud_with("doppler", kFloat64, std::numeric_limits<double>::infinity(), 1e300));
  ASSERT_EQ(doppler.size(), 2U);
  EXPECT_TRUE(std::isnan(doppler[0]));
  EXPECT_TRUE(std::isnan(doppler[1]));
}

TEST(Doppler, StaysWithItsPoints) {
  Sweep sweep;
  sweep.stamp = Nanoseconds(1700000000000000000);
  for (int i = 0; i < 5; ++i) {
    const auto x = static_cast<float>(i + 1);
    sweep.points.push_back({x, -x, 0.5F, 10.0F * x});
    sweep.times.push_back(0.02F * static_cast<float>(i));
    sweep.rings.push_back(static_cast<uint16_t>(i));
    sweep.doppler.push_back(i == 3 ? std::numeric_limits<float>::quiet_NaN() : 0.5F * x);
  }
  for (const bool intensity : {true, false}) {
    for (const bool times : {true, false}) {
      Sweep written = sweep;
      if (!times) {
        written.times.clear();
        written.rings.clear();
      }
      const CloudMessage cloud = to_cloud(written, "lidar", intensity);
      EXPECT_EQ(cloud.message.fields.back().name, "doppler");
      const Sweep read = to_sweep(cloud.message, written.stamp, "drive").sweep;
      EXPECT_EQ(read.times, written.times);
      EXPECT_EQ(read.rings, written.rings);
      ASSERT_EQ(read.doppler.size(), 5U);
      for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(read.points[i].x, written.points[i].x);
        EXPECT_TRUE(read.doppler[i] == written.doppler[i] || i == 3) << i;
      }
      EXPECT_TRUE(std::isnan(read.doppler[3]));
    }
  }
}

TEST(Doppler, OfAFileOfPointsIsReadToo) {
  const CloudFile cloud = parse_pcd("a.pcd",
                                    "VERSION .7\nFIELDS x y z doppler\nSIZE 4 4 4 4\nTYPE F F F F\n"
                                    "COUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n"
                                    "1 2 3 -0.5\n4 5 6 nan\n",
                                    {});
  ASSERT_EQ(cloud.sweep.doppler.size(), 2U);
  EXPECT_EQ(cloud.sweep.doppler[0], -0.5F);
  EXPECT_TRUE(std::isnan(cloud.sweep.doppler[1]));
}

}  // namespace
}  // namespace adit::ros
