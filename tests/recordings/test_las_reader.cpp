// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/las_reader.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/returns.hpp"

namespace adit {
namespace {

TEST(LasReader, PointsIntensityAndTimesOfEveryFormat) {
  struct Format {
    uint8_t format;
    std::size_t bytes;
    std::size_t time_at;
  };
  for (const Format f : {Format{0, 20, 0},
                         {1, 28, 20},
                         {2, 26, 0},
                         {3, 34, 20},
                         {4, 57, 20},
                         {5, 63, 20},
                         {6, 30, 22},
                         {7, 36, 22},
                         {8, 40, 22},
                         {9, 59, 22},
                         {10, 67, 22}}) {
    const uint8_t minor = f.format < 6 ? 2 : 4;
    const CloudFile cloud = parse_las("a.las", test::las_file(f.format, minor, f.bytes, f.time_at));
    ASSERT_EQ(cloud.sweep.points.size(), 2U) << int{f.format};
    EXPECT_FLOAT_EQ(cloud.sweep.points[0].x, 1.5F);
    EXPECT_FLOAT_EQ(cloud.sweep.points[0].y, -2.0F);
    EXPECT_FLOAT_EQ(cloud.sweep.points[0].z, 0.25F);
    EXPECT_FLOAT_EQ(cloud.sweep.points[1].z, 6.0F);
    EXPECT_EQ(cloud.sweep.points[1].intensity, 101.0F);
    EXPECT_EQ(cloud.absolute_stamp, f.time_at > 0);
    if (f.time_at > 0) {
      EXPECT_EQ(cloud.sweep.stamp, std::chrono::seconds(300000));
      EXPECT_FLOAT_EQ(cloud.sweep.times.at(1), 0.5F);
    } else {
      EXPECT_TRUE(cloud.sweep.times.empty());
    }
  }
}

TEST(LasReader, FoldersOfThemAreRecordings) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "1.las", std::ios::binary) << test::las_file(0, 2, 20, 0);
  std::ofstream(folder / "2.las", std::ios::binary) << test::las_file(0, 2, 20, 0);
  const auto recording = open_recording(folder.path());
  EXPECT_EQ(recording->topics()[0].type, "LAS");
  EXPECT_EQ(test::read_all(*recording).events.size(), 2U);
}

TEST(LasReader, WhatItIsNotIsNamed) {
  const auto found = [](const std::string& bytes) {
    try {
      parse_las("a.las", bytes);
    } catch (const InputError& error) {
      return error.found();
    }
    return std::string("nothing");
  };
  const std::string good = test::las_file(1, 2, 28, 20);
  EXPECT_EQ(found(good), "nothing");
  for (std::size_t size = 0; size < good.size() - 28; ++size) {
    EXPECT_NE(found(good.substr(0, size)), "nothing") << size;
  }
  std::string packed = good;
  test::put_at(packed, 104, uint8_t{0x81});
  EXPECT_NE(found(packed).find("packed"), std::string::npos);
  std::string many = good;
  test::put_at(many, 107, uint32_t{0xffffffff});
  EXPECT_NE(found(many.substr(0, 240)).find("promises 4294967295 points"), std::string::npos);
}

TEST(LasReader, PointsThatAreThereAreReadWhateverTheHeaderPromises) {
  const std::string good = test::las_file(1, 2, 28, 20);
  const auto expect_one_fault = [](const std::string& bytes, std::size_t there) {
    const CloudFile cloud = parse_las("a.las", bytes);
    EXPECT_EQ(cloud.sweep.points.size(), there);
    ASSERT_EQ(cloud.faults.size(), 1U);
    EXPECT_NE(cloud.faults[0].found().find("the file holds " + std::to_string(there)),
              std::string::npos)
        << cloud.faults[0].found();
  };
  expect_one_fault(good.substr(0, good.size() - 28), 1);
  expect_one_fault(good.substr(0, good.size() - 3), 1);
  expect_one_fault(good + good.substr(good.size() - 28), 3);
  std::string many = good;
  test::put_at(many, 107, uint32_t{0xffffffff});
  expect_one_fault(many, 2);
  // Version 1.4 may have other records behind the points, and some leave its own count at 0.
  std::string newer = test::las_file(6, 4, 30, 22);
  EXPECT_TRUE(parse_las("a.las", newer + newer.substr(newer.size() - 30)).faults.empty());
  test::put_at(newer, 247, uint64_t{0});
  EXPECT_EQ(parse_las("a.las", newer).sweep.points.size(), 2U);
}

/// A hundred points a millimetre apart, the first at `offset` (m), a millisecond after each other.
std::string las_survey(const std::array<double, 3>& offset) {
  std::string bytes = test::las_file(1, 2, 28, 20).substr(0, 227);
  test::put_at(bytes, 107, uint32_t{100});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    test::put_at(bytes, 155 + 8 * axis, offset[axis]);
  }
  for (int32_t i = 0; i < 100; ++i) {
    std::string point(28, '\0');
    for (std::size_t axis = 0; axis < 3; ++axis) {
      test::put_at(point, 4 * axis, i * static_cast<int32_t>(axis + 1));
    }
    test::put_at(point, 20, 300000.0 + 0.001 * i);
    bytes += point;
  }
  return bytes;
}

TEST(LasReader, OneImpossibleTimeLeavesOneOfManyPointsOut) {
  for (const double time : {1e300, -1e300, std::nan(""), 1e9}) {
    std::string bytes = las_survey({1.0, 2.0, 3.0});
    test::put_at(bytes, 227 + 28 * 50 + 20, time);
    const CloudFile cloud = parse_las("a.las", bytes);
    ASSERT_EQ(cloud.sweep.points.size(), 100U);
    EXPECT_TRUE(std::isnan(cloud.sweep.points[50].x));
    EXPECT_FLOAT_EQ(cloud.sweep.points[51].x, 1.051F);
    EXPECT_NEAR(cloud.sweep.times[99], 0.099F, 1e-6F);
    ASSERT_EQ(cloud.faults.size(), 1U) << time;
    EXPECT_EQ(cloud.faults[0].place(), "point 50");
    EXPECT_NE(cloud.faults[0].found().find("1 of 100 points"), std::string::npos);
    EXPECT_LT(std::string(cloud.faults[0].what()).size(), 200U);
  }
}

TEST(LasReader, ASurveyThatLastsLongerThanASweepKeepsItsPoints) {
  std::string bytes = las_survey({1.0, 2.0, 3.0});
  for (int i = 0; i < 100; ++i) {
    test::put_at(bytes, 227 + 28 * static_cast<std::size_t>(i) + 20, 300000.0 + i);
  }
  const CloudFile cloud = parse_las("a.las", bytes);
  EXPECT_EQ(cloud.sweep.points.size(), 100U);
  EXPECT_TRUE(cloud.sweep.times.empty());
  ASSERT_EQ(cloud.faults.size(), 1U);
  EXPECT_NE(cloud.faults[0].found().find("times of all points are left out"), std::string::npos);
}

TEST(LasReader, LargeCoordinatesKeepTheirMillimetres) {
  const CloudFile cloud = parse_las("a.las", las_survey({430000.0, 5400000.0, 300.0}));
  EXPECT_EQ(cloud.sweep.offset, Eigen::Vector3d(430000.0, 5400000.0, 300.0));
  EXPECT_EQ(cloud.coordinate_step, 0.0);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_NEAR(cloud.sweep.points[i].y, 0.002 * static_cast<double>(i), 1e-6);
    EXPECT_TRUE(is_return(cloud.sweep.points[i])) << i;  // also the one at the offset itself
  }
  // All clouds of a recording have the first one's.
  const CloudReading reading{.offset = Eigen::Vector3d(429000.0, 5400000.0, 300.0)};
  const CloudFile later = parse_las("b.las", las_survey({430000.0, 5400000.0, 300.0}), reading);
  EXPECT_EQ(later.sweep.offset, *reading.offset);
  EXPECT_NEAR(later.sweep.points[1].x, 1000.001, 1e-4);
  // Far from it they would lose what they have.
  EXPECT_THROW(parse_las("c.las", las_survey({460000.0, 5400000.0, 300.0}), reading), InputError);
}

TEST(LasReader, DamagedHeadersAreReadToAnEnd) {
  std::mt19937 random(4);
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = test::las_file(6, 4, 30, 22);
    for (int k = 0; k < 3; ++k) {
      bytes[random() % bytes.size()] = static_cast<char>(random() % 3U == 0 ? 0xff : random());
    }
    try {
      EXPECT_LE(parse_las("a.las", bytes).sweep.points.size(), 30U);
    } catch (const InputError&) {
      // the other right answer
    }
  }
}

}  // namespace
}  // namespace adit
