// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/camera_support.hpp"
#include "adit/tests/support/error_text.hpp"
#include "adit/tools/cameras/message_images.hpp"
#include "adit/tools/recordings/message_files.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::CameraRecorder;
using test::Container;
using test::kStart;

constexpr Nanoseconds kImagePeriod = std::chrono::milliseconds(100);
constexpr Nanoseconds kDelay = std::chrono::milliseconds(30);
constexpr unsigned kImages = 60;

Nanoseconds stamp_of_image(unsigned i) {
  return kStart + i * kImagePeriod;
}

SharedMessageFiles open_shared(const std::vector<fs::path>& paths) {
  return std::make_shared<const std::vector<std::unique_ptr<MessageFile>>>(
      open_message_files(paths));
}

/// Images from `first` on; 5 arrives after 6, and 8 at the same time as 9. Other topics lie
/// between.
fs::path record_images(const test::TemporaryFolder& folder, const std::string& name,
                       Container container, unsigned first = 0, unsigned count = kImages) {
  CameraRecorder recorder(folder, name, container);
  for (unsigned place = first; place < first + count; ++place) {
    const unsigned i = place == 5 ? 6 : place == 6 ? 5 : place;
    const Nanoseconds received = stamp_of_image(place == 9 ? 8 : place) + kDelay;
    recorder.write_image("/front/image_raw", received, stamp_of_image(i), i);
    for (unsigned k = 0; k < 5; ++k) {
      recorder.write("/imu", received, test::imu_message(i));
    }
    recorder.write_jpeg("/rear/image/compressed", received, stamp_of_image(i) + kImagePeriod / 2,
                        i);
  }
  return recorder.close();
}

/// The blue of the first pixel, by which the images differ.
unsigned shade_of(const ImageSeries& series, std::size_t index) {
  return series.image(index).rgb.at(2);
}

class MessageImages : public testing::TestWithParam<Container> {
 protected:
  test::TemporaryFolder folder_;
};

TEST_P(MessageImages, AreReadInAnyOrderByTheirStamps) {
  const SharedMessageFiles files = open_shared({record_images(folder_, "drive", GetParam())});
  const auto series = read_message_images(files, {"/front/image_raw", "/rear/image/compressed"});
  ASSERT_EQ(series.size(), 2U);
  ASSERT_EQ(series[0]->stamps().size(), kImages);
  ASSERT_EQ(series[1]->stamps().size(), kImages);
  std::vector<std::size_t> order(kImages);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(3);
  for (int turn = 0; turn < 4; ++turn) {
    for (const std::size_t i : order) {
      EXPECT_EQ(series[0]->stamps()[i], stamp_of_image(static_cast<unsigned>(i)));
      EXPECT_EQ(series[1]->stamps()[i],
                stamp_of_image(static_cast<unsigned>(i)) + kImagePeriod / 2);
      ASSERT_EQ(shade_of(*series[0], i), i) << "turn " << turn;
      ASSERT_NEAR(shade_of(*series[1], i), static_cast<double>(i), 8.0);
    }
    if (turn == 0) {
      std::ranges::reverse(order);
    } else {
      std::ranges::shuffle(order, random);
    }
  }
  EXPECT_EQ(series[0]->image(0).rgb, test::color_picture(8, 6, 0).rgb);
}

TEST_P(MessageImages, OfSeveralFilesAreOneSeries) {
  const fs::path first = record_images(folder_, "a", GetParam(), 0, 20);
  const fs::path second = record_images(folder_, "b", GetParam(), 20, 20);
  const auto series = read_message_images(open_shared({second, first}), {"/front/image_raw"});
  ASSERT_EQ(series[0]->stamps().size(), 40U);
  for (const unsigned i : {0U, 19U, 20U, 39U, 10U, 30U, 5U}) {
    EXPECT_EQ(series[0]->stamps()[i], stamp_of_image(i));
    EXPECT_EQ(shade_of(*series[0], i), i);
  }
}

INSTANTIATE_TEST_SUITE_P(Containers, MessageImages, testing::ValuesIn(test::kContainers));

/// Bytes that this process has read so far.
uint64_t bytes_read() {
  std::ifstream file("/proc/self/io");
  std::string word;
  uint64_t bytes = 0;
  file >> word >> bytes;
  return word == "rchar:" ? bytes : 0;
}

TEST(MessageImageAccess, AnImageCostsNoPassOverTheFile) {
  constexpr unsigned kMany = 200;
  for (const Container container : {Container::mcap, Container::bag, Container::rosbag2}) {
    const test::TemporaryFolder folder;
    CameraRecorder recorder(folder, "large", container, 200000);
    std::mt19937 random(1);
    ColorImage noise{.width = 100, .height = 100, .rgb = std::vector<uint8_t>(30000)};
    for (unsigned i = 0; i < kMany; ++i) {
      std::ranges::generate(noise.rgb, [&] { return static_cast<uint8_t>(random() & 0xffU); });
      noise.rgb[2] = static_cast<uint8_t>(i);
      ros::Image image;
      image.header.stamp = stamp_of_image(i);
      image.width = image.height = 100;
      image.encoding = "rgb8";
      image.step = 300;
      image.data = std::as_bytes(std::span(noise.rgb));
      recorder.write("/image", stamp_of_image(i), image);
    }
    const auto series = read_message_images(open_shared({recorder.close()}), {"/image"});
    const auto cost = [&](const std::vector<unsigned>& indices) {
      const uint64_t before = bytes_read();
      for (const unsigned i : indices) {
        EXPECT_EQ(shade_of(*series[0], i), i);
      }
      return bytes_read() - before;
    };
    ASSERT_GT(bytes_read(), 0U) << "/proc/self/io counts what a process reads";
    constexpr uint64_t kFile = uint64_t{kMany} * 30000;
    std::vector<unsigned> all(kMany);
    std::iota(all.begin(), all.end(), 0);
    EXPECT_LT(cost({190, 20, 100}), kFile / 4) << static_cast<int>(container);
    EXPECT_LT(cost(all), 2 * kFile) << static_cast<int>(container);
  }
}

TEST(MessageImageAccess, HeadersWithoutAStampCountAsTakenWhenReceived) {
  const test::TemporaryFolder folder;
  CameraRecorder recorder(folder, "zero", Container::mcap);
  recorder.write_image("/image", kStart, Nanoseconds(0), 1);
  const auto series = read_message_images(open_shared({recorder.close()}), {"/image", "/none"});
  ASSERT_EQ(series[0]->stamps().size(), 1U);
  EXPECT_EQ(series[0]->stamps()[0], kStart);
  EXPECT_TRUE(series[1]->stamps().empty());
}

TEST(MessageImageAccess, DamagedImagesNameTheirFileAndTopic) {
  const test::TemporaryFolder folder;
  CameraRecorder recorder(folder, "damaged", Container::mcap);
  recorder.write_image("/image", kStart, kStart, 1);
  ros::Image image;
  image.header.stamp = kStart + kImagePeriod;
  image.width = image.height = 100;
  image.encoding = "rgb8";
  image.step = 300;
  recorder.write("/image", kStart + kImagePeriod, image);
  recorder.write_image("/image", kStart + 2 * kImagePeriod, kStart + 2 * kImagePeriod, 3);
  const auto series = read_message_images(open_shared({recorder.close()}), {"/image"});
  const std::string error = test::error_of<InputError>([&] { series[0]->image(1); });
  EXPECT_NE(error.find("damaged.mcap, byte "), std::string::npos) << error;
  EXPECT_NE(error.find("of the images on /image, number 1: the 0 bytes"), std::string::npos)
      << error;
  EXPECT_EQ(shade_of(*series[0], 0), 1U);
  EXPECT_EQ(shade_of(*series[0], 2), 3U);
}

TEST(MessageImageAccess, ChunksThatCannotBeUnpackedCostTheirOwnImages) {
  const test::TemporaryFolder folder;
  const fs::path whole = record_images(folder, "whole", Container::mcap);
  std::string bytes = test::content_of(whole);
  const std::size_t middle = bytes.size() / 2;
  bytes.replace(middle, 40, std::string(40, '\x55'));
  const auto series =
      read_message_images(open_shared({folder.write("broken.mcap", bytes)}), {"/front/image_raw"});
  const std::size_t left = series[0]->stamps().size();
  EXPECT_LT(left, kImages);
  EXPECT_GT(left, kImages / 2);
  for (std::size_t i = 0; i < left; ++i) {
    EXPECT_EQ(stamp_of_image(shade_of(*series[0], i)), series[0]->stamps()[i]);
  }
}

}  // namespace
}  // namespace adit
