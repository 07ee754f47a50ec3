// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/tum_folder.hpp"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/depth_images.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/depth_png.hpp"

namespace adit {
namespace {

using test::depth_png;

const std::vector<uint16_t> kDepths = {0, 5000, 10000, 2500, 65535, 1};

/// Two images of 3 x 2 pixels, a pose and two accelerations.
class TumFolder : public testing::Test {
 protected:
  TumFolder() {
    folder_.write("depth/1.png", depth_png(3, kDepths));
    folder_.write("depth/2.png", depth_png(3, kDepths));
    folder_.write("depth.txt",
                  "# timestamp filename\n1305031102.160407 depth/1.png\n"
                  "1305031102.194330 depth/2.png\n");
    folder_.write("groundtruth.txt", "# t\n1305031102.1758 1.0 2.0 3.0 0 0 0.6 0.8\n");
    folder_.write("accelerometer.txt", "1305031102.1 -0.5 8.25 -2.5\n1305031102.3 -0.5 8.5 -2.5\n");
  }

  test::TemporaryFolder folder_;
};

TEST_F(TumFolder, ImagesPosesAndAccelerationsComeInTheOrderOfTime) {
  folder_.write("calibration.txt", "100 200 1.0 0.5\n");
  const auto recording = open_recording(folder_.path());
  ASSERT_EQ(recording->topics().size(), 3U);
  EXPECT_EQ(recording->topics()[0].messages, 2U);
  EXPECT_NE(recording->description().find("focal lengths 100.0, 200.0"), std::string::npos);
  const test::ReadEvents read = test::read_all(*recording);
  EXPECT_TRUE(read.errors.empty());
  ASSERT_EQ(read.events.size(), 5U);
  const auto& sample = std::get<ImuSample>(read.events[0].value);
  EXPECT_EQ(sample.linear_acceleration, Eigen::Vector3d(-0.5, 8.25, -2.5));
  EXPECT_TRUE(sample.angular_velocity.array().isNaN().all());
  const auto& sweep = std::get<Sweep>(read.events[1].value);
  EXPECT_EQ(sweep.stamp, Nanoseconds(1305031102160407000));
  ASSERT_EQ(sweep.points.size(), 6U);
  EXPECT_EQ(sweep.points[0].z, 0.0F);  // no return
  const Point& p = sweep.points[2];    // pixel (2, 0), 2 m away
  EXPECT_FLOAT_EQ(p.x, 2.0F * (2.0F - 1.0F) / 100.0F);
  EXPECT_FLOAT_EQ(p.y, 2.0F * (0.0F - 0.5F) / 200.0F);
  EXPECT_FLOAT_EQ(p.z, 2.0F);
  EXPECT_FLOAT_EQ(sweep.points[4].z, 65535.0F / 5000.0F);
  const auto& pose = std::get<ReferencePose>(read.events[2].value);
  EXPECT_EQ(pose.T_parent_child.translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_NEAR(pose.T_parent_child.linear()(1, 0), 2.0 * 0.6 * 0.8, 1e-12);
}

TEST_F(TumFolder, WithoutCalibrationTheDataSetsOwnCameraIsTaken) {
  const test::ReadEvents read = test::read_all(*open_recording(folder_.path()), {.topics = {0}});
  const Point& p = std::get<Sweep>(read.events.at(0).value).points.at(1);
  EXPECT_FLOAT_EQ(p.x, (1.0F - 319.5F) / 525.0F);
}

TEST_F(TumFolder, SelectionByTimeAndNumber) {
  const auto recording = open_recording(folder_.path());
  const Nanoseconds middle(1305031102170000000);
  EXPECT_EQ(test::read_all(*recording, {.topics = {0}, .begin = middle}).events.size(), 1U);
  EXPECT_EQ(test::read_all(*recording, {.topics = {0}, .end = middle}).events.size(), 1U);
  EXPECT_EQ(test::read_all(*recording, {.skip = 2}).events.size(), 3U);
}

TEST_F(TumFolder, WhatIsDamagedIsNamedAndTheRestIsRead) {
  folder_.write("depth/1.png", depth_png(3, kDepths).substr(0, 60));
  folder_.write("groundtruth.txt", "1305031102.1758 1.0 2.0 3.0 0 0 0 0\nx 1 2 3 0 0 0 1\n1 2\n");
  const test::ReadEvents read = test::read_all(*open_recording(folder_.path()));
  EXPECT_EQ(read.events.size(), 3U);
  ASSERT_EQ(read.errors.size(), 4U);
  std::string all;
  for (const InputError& error : read.errors) {
    all += error.file().filename().string() + ' ' + error.place() + ": " + error.found() + '\n';
  }
  EXPECT_NE(all.find("1.png byte"), std::string::npos) << all;
  EXPECT_NE(all.find("groundtruth.txt line 1: its quaternion has the length 0"), std::string::npos)
      << all;
  EXPECT_NE(all.find("line 2: 'x' is no time"), std::string::npos) << all;
  EXPECT_NE(all.find("line 3: it has 2 words, expected 8"), std::string::npos) << all;
}

TEST_F(TumFolder, ImagesThatAreMissingAreNamed) {
  folder_.write("depth.txt", "1305031102.160407 depth/9.png\n1305031102.194330 depth/2.png\n");
  const test::ReadEvents read = test::read_all(*open_recording(folder_.path()), {.topics = {0}});
  EXPECT_EQ(read.events.size(), 1U);
  ASSERT_EQ(read.errors.size(), 1U);
  EXPECT_EQ(read.errors[0].file().filename(), "9.png");
}

TEST_F(TumFolder, CalibrationThatIsNoneIsRefused) {
  for (const char* text : {"", "100 200 1.0", "100 200 1.0 x", "0 200 1 1", "nan 200 1 1"}) {
    folder_.write("calibration.txt", text);
    EXPECT_THROW(open_recording(folder_.path()), InputError) << text;
  }
}

std::string found_in(const std::string& content) {
  try {
    parse_depth_png("a.png", content);
  } catch (const InputError& error) {
    return error.found();
  }
  return "nothing";
}

TEST(DepthPng, ValuesAreExact) {
  const DepthPng image = parse_depth_png("a.png", depth_png(3, kDepths));
  EXPECT_EQ(image.width, 3U);
  EXPECT_EQ(image.height, 2U);
  EXPECT_EQ(image.values, kDepths);
}

TEST(DepthPng, CutOffAnywhereItIsRefused) {
  const std::string good = depth_png(3, kDepths);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_NE(found_in(good.substr(0, size)), "nothing") << size;
  }
}

TEST(DepthPng, OtherKindsAndSizesThatCannotBeAreRefused) {
  EXPECT_NE(found_in(depth_png(3, kDepths, {"\x08\x00", 2})).find("another kind"),
            std::string::npos);
  EXPECT_NE(found_in(depth_png(3, kDepths, {"\x10\x02", 2})).find("another kind"),
            std::string::npos);
  std::string bomb = depth_png(3, kDepths);
  const std::string head =
      test::big_endian(4000) + test::big_endian(4000) + std::string("\x10\x00\x00\x00\x00", 5);
  bomb.replace(8, 25, test::png_chunk("IHDR", head));
  EXPECT_NE(found_in(bomb).find("promises 4000 x 4000 pixels"), std::string::npos);
}

TEST(DepthPng, DamagedImagesAreReadToAnEnd) {
  std::mt19937 random(6);
  const std::string good = depth_png(3, kDepths);
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = good;
    for (int k = 0; k < 2; ++k) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    found_in(bytes);  // an image or an InputError
  }
}

}  // namespace
}  // namespace adit
