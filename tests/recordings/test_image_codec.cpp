// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/color_images.hpp"
#include "adit/tests/support/depth_images.hpp"
#include "adit/tests/support/error_text.hpp"
#include "adit/tools/cameras/image_codec.hpp"
#include "adit/tools/drawing/png_writer.hpp"

namespace adit {
namespace {

ColorImage decode_bytes(const std::string& bytes) {
  return decode_image(std::as_bytes(std::span(bytes)));
}

std::string error_of_image(const std::string& bytes) {
  return test::error_of<ImageError>([&] { decode_bytes(bytes); });
}

int largest_difference(const ColorImage& a, const ColorImage& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    largest = std::max(largest, std::abs(a.rgb[i] - b.rgb.at(i)));
  }
  return largest;
}

/// The picture as the drawing's PNG, three bytes a pixel.
std::string png_of(const ColorImage& picture) {
  Image image(static_cast<int>(picture.width), static_cast<int>(picture.height));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = {picture.rgb[3 * i], picture.rgb[3 * i + 1], picture.rgb[3 * i + 2]};
  }
  return png_bytes(image);
}

TEST(ImageCodec, JpegsHaveTheColoursThatWerePacked) {
  const ColorImage picture = test::color_picture(64, 48, 200);
  for (const int subsampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420}) {
    for (const int flags : {0, TJFLAG_PROGRESSIVE}) {
      const ColorImage image = decode_bytes(test::jpeg_bytes(picture, subsampling, flags));
      ASSERT_EQ(image.width, 64U);
      ASSERT_EQ(image.height, 48U);
      ASSERT_EQ(image.rgb.size(), picture.rgb.size());
      EXPECT_LE(largest_difference(picture, image), 12) << subsampling << ' ' << flags;
    }
  }
}

TEST(ImageCodec, GreyJpegsHaveThreeEqualColours) {
  const ColorImage image = decode_bytes(test::jpeg_bytes(test::color_picture(16, 8), TJSAMP_GRAY));
  ASSERT_EQ(image.rgb.size(), 3U * 16 * 8);
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    EXPECT_EQ(image.rgb[i], image.rgb[i + 1]);
    EXPECT_EQ(image.rgb[i], image.rgb[i + 2]);
  }
  EXPECT_GT(image.rgb[3 * 15], image.rgb[0]);
}

TEST(ImageCodec, PngsKeepEachColour) {
  const ColorImage picture = test::color_picture(30, 20, 77);
  const ColorImage image = decode_bytes(png_of(picture));
  EXPECT_EQ(image.width, 30U);
  EXPECT_EQ(image.height, 20U);
  EXPECT_EQ(image.rgb, picture.rgb);
}

TEST(ImageCodec, PngsWithOpacityLoseIt) {
  const std::vector<uint8_t> pixels = {1, 2, 3, 0, 4, 5, 6, 255};
  EXPECT_EQ(decode_bytes(png_bytes_with_alpha(2, 1, pixels)).rgb,
            (std::vector<uint8_t>{1, 2, 3, 4, 5, 6}));
}

TEST(ImageCodec, SixteenBitsAreRoundedToEight) {
  const ColorImage image = decode_bytes(test::depth_png(2, {0, 0xffff, 0x8080, 0x0100}));
  EXPECT_EQ(image.rgb, (std::vector<uint8_t>{0, 0, 0, 255, 255, 255, 128, 128, 128, 1, 1, 1}));
}

TEST(ImageCodec, BytesThatFollowAJpegDoNoHarm) {
  const ColorImage picture = test::color_picture(32, 32, 10);
  const std::string bytes = test::jpeg_bytes(picture);
  EXPECT_EQ(decode_bytes(bytes + std::string(1000, '\0')).rgb, decode_bytes(bytes).rgb);
}

TEST(ImageCodec, ImagesThatEndEarlyAreRefusedWhereverTheyEnd) {
  const ColorImage picture = test::color_picture(40, 40, 99);
  for (const std::string& whole : {test::jpeg_bytes(picture), png_of(picture),
                                   test::jpeg_bytes(picture, TJSAMP_420, TJFLAG_PROGRESSIVE)}) {
    // A JPEG without its end mark has all of its pixels, and a PNG without its last sum.
    for (std::size_t size = 0; size + 16 < whole.size(); ++size) {
      EXPECT_THROW(decode_bytes(whole.substr(0, size)), ImageError)
          << size << " of " << whole.size();
    }
  }
}

TEST(ImageCodec, ErrorsNameWhatIsWrong) {
  const std::string jpeg = test::jpeg_bytes(test::color_picture(40, 40));
  EXPECT_EQ(error_of_image(""), "the image is neither a JPEG nor a PNG");
  EXPECT_EQ(error_of_image("GIF89a"), "the image is neither a JPEG nor a PNG");
  EXPECT_NE(error_of_image(jpeg.substr(0, 20)).find("it is no JPEG that can be read: "),
            std::string::npos);
  EXPECT_NE(error_of_image(jpeg.substr(0, jpeg.size() * 3 / 4)).find("its pixels cannot be read: "),
            std::string::npos);
}

/// The JPEG with another size in its header.
std::string with_size(std::string jpeg, unsigned width, unsigned height) {
  const std::size_t frame = jpeg.find("\xff\xc0");
  EXPECT_NE(frame, std::string::npos);
  const std::string size = test::big_endian(height, 2) + test::big_endian(width, 2);
  return jpeg.replace(frame + 5, 4, size);
}

TEST(ImageCodec, MemoryIsNotTakenForPixelsThatCannotBeThere) {
  const std::string jpeg = test::jpeg_bytes(test::color_picture(16, 16));
  EXPECT_NE(error_of_image(with_size(jpeg, 16000, 16000)).find("bytes cannot hold"),
            std::string::npos);
  EXPECT_NE(error_of_image(with_size(jpeg, 16385, 8)).find("expected 1 to 16384"),
            std::string::npos);
  EXPECT_NE(error_of_image(with_size(jpeg, 8, 16385)).find("expected 1 to 16384"),
            std::string::npos);
  std::string png = png_of(test::color_picture(16, 16));
  const std::string head = test::big_endian(16000) + test::big_endian(16000) + png.substr(24, 5);
  png.replace(8, 25, test::png_chunk("IHDR", head));
  EXPECT_NE(error_of_image(png).find("bytes cannot hold"), std::string::npos);
}

TEST(ImageCodec, DamageGivesAnErrorOrAnImageAndNothingElse) {
  std::mt19937 random(7);
  const ColorImage picture = test::color_picture(48, 32, 50);
  std::size_t refused = 0;
  std::size_t read = 0;
  for (const std::string& whole : {test::jpeg_bytes(picture), png_of(picture),
                                   test::jpeg_bytes(picture, TJSAMP_420, TJFLAG_PROGRESSIVE)}) {
    for (int turn = 0; turn < 1500; ++turn) {
      std::string bytes = whole;
      for (int change = 0; change <= turn % 4; ++change) {
        bytes[random() % bytes.size()] = static_cast<char>(random() & 0xffU);
      }
      try {
        const ColorImage image = decode_bytes(bytes);
        EXPECT_EQ(image.rgb.size(), 3 * image.width * image.height);
        ++read;
      } catch (const ImageError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 1000U);
  EXPECT_GT(read, 100U);
}

TEST(ImageCodec, RandomBytesBehindAMagicAreRefused) {
  std::mt19937 random(11);
  for (const std::string magic : {"\xff\xd8\xff\xe0", "\x89PNG\r\n\x1a\n"}) {
    for (int turn = 0; turn < 500; ++turn) {
      std::string bytes = magic;
      for (auto i = random() % 300; i > 0; --i) {
        bytes += static_cast<char>(random() & 0xffU);
      }
      EXPECT_THROW(decode_bytes(bytes), ImageError);
    }
  }
}

}  // namespace
}  // namespace adit
