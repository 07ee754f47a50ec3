// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/error_text.hpp"
#include "adit/tools/cameras/image_codec.hpp"
#include "adit/tools/cameras/message_pixels.hpp"

namespace adit {
namespace {

using Values = std::vector<uint8_t>;

ros::Image image_message(const std::string& encoding, uint32_t width, uint32_t height,
                         uint32_t step, const Values& bytes) {
  ros::Image image;
  image.encoding = encoding;
  image.width = width;
  image.height = height;
  image.step = step;
  image.data = std::as_bytes(std::span(bytes));
  return image;
}

/// Of an image of one row.
Values colors_of(const std::string& encoding, uint32_t width, const Values& bytes) {
  return ros::to_color(
             image_message(encoding, width, 1, static_cast<uint32_t>(bytes.size()), bytes))
      .rgb;
}

TEST(MessagePixels, BytesOfAPixelAreInTheOrderOfTheirEncoding) {
  const Values expected = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(colors_of("rgb8", 2, {1, 2, 3, 4, 5, 6}), expected);
  EXPECT_EQ(colors_of("bgr8", 2, {3, 2, 1, 6, 5, 4}), expected);
  EXPECT_EQ(colors_of("8UC3", 2, {3, 2, 1, 6, 5, 4}), expected);
  EXPECT_EQ(colors_of("rgba8", 2, {1, 2, 3, 0, 4, 5, 6, 9}), expected);
  EXPECT_EQ(colors_of("bgra8", 2, {3, 2, 1, 0, 6, 5, 4, 9}), expected);
  EXPECT_EQ(colors_of("8UC4", 2, {3, 2, 1, 0, 6, 5, 4, 9}), expected);
  EXPECT_EQ(colors_of("mono8", 2, {7, 8}), (Values{7, 7, 7, 8, 8, 8}));
  EXPECT_EQ(colors_of("8UC1", 2, {7, 8}), (Values{7, 7, 7, 8, 8, 8}));
}

TEST(MessagePixels, RowsMayBeLongerThanTheirPixels) {
  const Values bytes = {1, 2, 3, 99, 99, 4, 5, 6};  // the last row ends with its pixels
  const ColorImage image = ros::to_color(image_message("rgb8", 1, 2, 5, bytes));
  EXPECT_EQ(image.width, 1U);
  EXPECT_EQ(image.height, 2U);
  EXPECT_EQ(image.rgb, (Values{1, 2, 3, 4, 5, 6}));
}

TEST(MessagePixels, LumaAndChromaGiveTheColoursOfBt601) {
  // Black, white, and the primaries of the standard's table (75 % bars aside), to a rounding.
  struct Case {
    uint8_t y, u, v;
    std::array<int, 3> rgb;
  };
  const std::array<Case, 6> cases = {{{16, 128, 128, {0, 0, 0}},
                                      {235, 128, 128, {255, 255, 255}},
                                      {81, 90, 240, {255, 0, 0}},
                                      {145, 54, 34, {0, 255, 0}},
                                      {41, 240, 110, {0, 0, 255}},
                                      {126, 128, 128, {128, 128, 128}}}};
  for (const Case& one : cases) {
    for (const std::string encoding : {"uyvy", "yuv422", "yuyv", "yuv422_yuy2"}) {
      const bool chroma_first = encoding == "uyvy" || encoding == "yuv422";
      const Values bytes =
          chroma_first ? Values{one.u, one.y, one.v, 16} : Values{one.y, one.u, 16, one.v};
      const Values rgb = colors_of(encoding, 2, bytes);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(rgb[i], one.rgb[i], 2) << encoding << ' ' << int{one.y} << ' ' << i;
      }
    }
  }
  // The second brightness is that of the second pixel.
  EXPECT_EQ(colors_of("yuyv", 2, {16, 128, 235, 128}), (Values{0, 0, 0, 255, 255, 255}));
}

/// What a filter leaves of an image of one colour.
Values behind_filter(const std::string& pattern, std::size_t width, std::size_t height,
                     const std::array<uint8_t, 3>& color) {
  Values values;
  for (std::size_t row = 0; row < height; ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      const char seen = pattern[2 * (row % 2) + column % 2];
      values.push_back(color[seen == 'r' ? 0 : seen == 'g' ? 1 : 2]);
    }
  }
  return values;
}

TEST(MessagePixels, BayerFiltersGiveBackAnEvenColour) {
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    for (const uint32_t width : {2U, 5U, 6U}) {
      const Values values = behind_filter(pattern, width, 5, {200, 100, 50});
      const ColorImage image =
          ros::to_color(image_message("bayer_" + pattern + "8", width, 5, width, values));
      ASSERT_EQ(image.rgb.size(), 3 * 5 * width);
      for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        EXPECT_EQ(image.rgb[i], 200) << pattern << ' ' << i;
        EXPECT_EQ(image.rgb[i + 1], 100) << pattern << ' ' << i;
        EXPECT_EQ(image.rgb[i + 2], 50) << pattern << ' ' << i;
      }
    }
  }
}

TEST(MessagePixels, BayerFiltersAreInterpolatedBetweenNeighbours) {
  // rggb; the pixel (1, 1) sees blue, (2, 1) and (1, 2) green.
  const Values values = {10, 20, 30, 40,  //
                         50, 60, 70, 80,  //
                         90, 11, 21, 31,  //
                         41, 51, 61, 71};
  const ColorImage image = ros::to_color(image_message("bayer_rggb8", 4, 4, 4, values));
  const auto at = [&](std::size_t column, std::size_t row) {
    const std::size_t first = 3 * (4 * row + column);
    return std::array<int, 3>{image.rgb[first], image.rgb[first + 1], image.rgb[first + 2]};
  };
  EXPECT_EQ(at(1, 1), (std::array<int, 3>{38, 38, 60}));  // (10+30+90+21)/4, (20+50+70+11)/4
  EXPECT_EQ(at(2, 1), (std::array<int, 3>{26, 70, 70}));  // (30+21)/2, itself, (60+80)/2
  EXPECT_EQ(at(1, 2), (std::array<int, 3>{56, 11, 56}));  // (90+21)/2, itself, (60+51)/2
  EXPECT_EQ(at(0, 0), (std::array<int, 3>{10, 35, 60}));  // mirrored: (20+20+50+50)/4
}

TEST(MessagePixels, MessagesWithFewerBytesThanPixelsAreRefused) {
  const Values bytes(24, 1);
  EXPECT_NO_THROW(ros::to_color(image_message("rgb8", 4, 2, 12, bytes)));
  const auto refused = [&](const ros::Image& image) {
    return test::error_of<ImageError>([&] { ros::to_color(image); });
  };
  EXPECT_EQ(refused(image_message("rgb8", 4, 3, 12, bytes)),
            "the 24 bytes of the image in rows of 12 are fewer than 4 x 3 pixels of the encoding "
            "'rgb8' take");
  EXPECT_NE(refused(image_message("rgb8", 5, 2, 12, bytes)), "no error");
  EXPECT_NE(refused(image_message("rgb8", 4, 2, 0xffffffffU, bytes)), "no error");
  EXPECT_NE(refused(image_message("rgb8", 0, 2, 12, bytes)), "no error");
  EXPECT_NE(refused(image_message("rgb8", 4, 0, 12, bytes)), "no error");
  EXPECT_NE(refused(image_message("mono8", 16385, 1, 16385, Values(16385))), "no error");
  EXPECT_NE(refused(image_message("yuyv", 3, 1, 6, bytes)), "no error");
  EXPECT_NE(refused(image_message("bayer_rggb8", 1, 4, 1, bytes)), "no error");
  EXPECT_NE(refused(image_message("16UC1", 2, 2, 4, bytes)).find("not read as colours"),
            std::string::npos);
}

bool is_packed_depth(const std::string& format) {
  ros::CompressedImage image;
  image.format = format;
  return ros::is_depth(image);
}

TEST(MessagePixels, DepthsAndUnknownEncodingsAreNoColours) {
  for (const char* encoding : {"16UC1", "32FC1", "mono16", "rgb16", ""}) {
    EXPECT_EQ(ros::kind_of_pixels(encoding), ros::PixelKind::none) << encoding;
  }
  EXPECT_EQ(ros::kind_of_pixels("mono8"), ros::PixelKind::grey);
  EXPECT_EQ(ros::kind_of_pixels("bayer_grbg8"), ros::PixelKind::colors);
  EXPECT_EQ(ros::kind_of_pixels("yuyv"), ros::PixelKind::colors);
  EXPECT_TRUE(is_packed_depth("16UC1; compressedDepth"));
  EXPECT_TRUE(is_packed_depth("16UC1; png compressed "));
  EXPECT_FALSE(is_packed_depth("bgr8; jpeg compressed bgr8"));
}

}  // namespace
}  // namespace adit
