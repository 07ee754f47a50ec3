// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/bin_reader.hpp"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

/// Points on the walls of a room, with the extra columns that a layout has.
std::string room(std::size_t points, const std::string& layout) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::string bytes;
  for (std::size_t i = 0; i < points; ++i) {
    const float turn = 6.2831853F * static_cast<float>(i) / static_cast<float>(points);
    const float range = 4.0F + 3.0F * unit(random);
    bytes += test::bytes_of_all(range * std::cos(turn), range * std::sin(turn),
                                -1.5F + 3.0F * unit(random));
    for (const char column : layout) {
      const float value = column == 'i'   ? std::floor(200.0F * unit(random)) / 255.0F
                          : column == 'r' ? static_cast<float>(i % 32)
                          : column == 't'
                              ? 0.1F * static_cast<float>(i) / static_cast<float>(points)
                              : unit(random) - 0.5F;
      bytes += test::bytes_of(value);
    }
  }
  return bytes;
}

TEST(BinReader, FindsHowManyNumbersAPointHas) {
  for (const std::size_t points : {60U, 1000U, 20000U}) {
    for (const char* layout : {"", "i", "ir", "irt", "itr", "irx", "irxt"}) {
      const CloudFile cloud = parse_bin("a.bin", room(points, layout));
      const std::string text(layout);
      EXPECT_EQ(cloud.sweep.points.size(), points) << layout;
      EXPECT_EQ(cloud.floats_per_point, 3U + text.size()) << layout;
      EXPECT_EQ(cloud.sweep.rings.empty(), text.find('r') == text.npos) << layout;
      EXPECT_EQ(cloud.sweep.times.empty(), text.find('t') == text.npos) << layout;
      EXPECT_EQ(cloud.has_intensity, !text.empty()) << layout;
      EXPECT_TRUE(cloud.sweep.doppler.empty()) << layout;
      EXPECT_TRUE(cloud.faults.empty());
      if (text.find('r') != text.npos) {
        EXPECT_EQ(cloud.sweep.rings[33], 1U) << layout;
      }
    }
  }
}

TEST(BinReader, AFileThatEndsWithinAPointIsReadUpToThere) {
  const std::string whole = room(100, "ir");
  const CloudFile cloud = parse_bin("a.bin", whole.substr(0, whole.size() - 3));
  EXPECT_EQ(cloud.sweep.points.size(), 99U);
  ASSERT_EQ(cloud.faults.size(), 1U);
  EXPECT_NE(cloud.faults[0].found().find("17 are left over after 99 points"), std::string::npos)
      << cloud.faults[0].found();
}

TEST(BinReader, NumbersWithoutAnOrderNeedToBeTold) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::string noise;
  for (int i = 0; i < 5 * 333; ++i) {
    noise += test::bytes_of(normal(random));
  }
  for (const std::string& bytes : {noise, std::string(noise.size(), '\0')}) {
    try {
      parse_bin("a.bin", bytes);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_NE(error.remedy().find("recording.floats_per_point"), std::string::npos);
    }
    EXPECT_EQ(parse_bin("a.bin", bytes, {.floats_per_point = 5}).sweep.points.size(), 333U);
    // KITTI's layout needs no proof.
    EXPECT_EQ(parse_bin("a.bin", bytes.substr(0, 1600)).sweep.points.size(), 100U);
  }
}

TEST(BinReader, ARecordingSaysWhatItsNumbersLookLike) {
  const test::TemporaryFolder folder;
  folder.write("velodyne/0.bin", room(1000, "irt"));
  folder.write("velodyne/1.bin", room(20, "irt"));  // too few to tell by themselves
  const auto recording = open_recording(folder.path());
  EXPECT_NE(recording->description().find("a point has 6 floats (x y z intensity ring time)"),
            std::string::npos)
      << recording->description();
  const test::ReadEvents read = test::read_all(*recording);
  ASSERT_EQ(read.events.size(), 2U);
  EXPECT_EQ(std::get<Sweep>(read.events[1].value).points.size(), 20U);
  EXPECT_TRUE(read.errors.empty());
}

}  // namespace
}  // namespace adit
