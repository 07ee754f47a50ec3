// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/recordings/las_reader.hpp"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/recordings/event_support.hpp"
#include "tests/support/temporary_folder.hpp"

namespace adit {
namespace {

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

/// Two points, (1.5, -2, 0.25) and (4, 5, 6) m, half a second apart where the format has times.
std::string las(uint8_t format, uint8_t minor, std::size_t point_bytes, std::size_t time_at) {
  const std::size_t header = minor >= 4 ? 375 : 227;
  std::string bytes(header + 2 * point_bytes, '\0');
  std::memcpy(bytes.data(), "LASF", 4);
  put(bytes, 24, uint8_t{1});
  put(bytes, 25, minor);
  put(bytes, 96, static_cast<uint32_t>(header));
  put(bytes, 104, format);
  put(bytes, 105, static_cast<uint16_t>(point_bytes));
  put(bytes, 107, uint32_t{2});
  if (minor >= 4) {
    put(bytes, 247, uint64_t{2});
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(bytes, 131 + 8 * axis, 0.001);
    put(bytes, 155 + 8 * axis, 1.0);
  }
  const int32_t points[2][3] = {{500, -3000, -750}, {3000, 4000, 5000}};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t at = header + i * point_bytes;
    std::memcpy(bytes.data() + at, points[i], sizeof points[i]);
    put(bytes, at + 12, static_cast<uint16_t>(100 + i));
    if (time_at > 0) {
      put(bytes, at + time_at, 300000.0 + 0.5 * static_cast<double>(i));
    }
  }
  return bytes;
}

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
    const CloudFile cloud = parse_las("a.las", las(f.format, minor, f.bytes, f.time_at));
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
  std::ofstream(folder / "1.las", std::ios::binary) << las(0, 2, 20, 0);
  std::ofstream(folder / "2.las", std::ios::binary) << las(0, 2, 20, 0);
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
  const std::string good = las(1, 2, 28, 20);
  EXPECT_EQ(found(good), "nothing");
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_NE(found(good.substr(0, size)), "nothing") << size;
  }
  std::string packed = good;
  put(packed, 104, uint8_t{0x81});
  EXPECT_NE(found(packed).find("packed"), std::string::npos);
  std::string many = good;
  put(many, 107, uint32_t{0xffffffff});
  EXPECT_NE(found(many).find("promises 4294967295 points"), std::string::npos);
}

TEST(LasReader, DamagedHeadersAreReadToAnEnd) {
  std::mt19937 random(4);
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = las(6, 4, 30, 22);
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
