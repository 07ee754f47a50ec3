// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/las_reader.hpp"

#include <cstdint>
#include <fstream>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"

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
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_NE(found(good.substr(0, size)), "nothing") << size;
  }
  std::string packed = good;
  test::put_at(packed, 104, uint8_t{0x81});
  EXPECT_NE(found(packed).find("packed"), std::string::npos);
  std::string many = good;
  test::put_at(many, 107, uint32_t{0xffffffff});
  EXPECT_NE(found(many).find("promises 4294967295 points"), std::string::npos);
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
