// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cameras/message_pixels.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "adit/tools/cameras/bayer.hpp"
#include "adit/tools/cameras/image_codec.hpp"

namespace adit::ros {
namespace {

/// How the bytes of a pixel lie.
enum class Form { interleaved, bayer, luma_chroma };

struct Layout {
  std::string_view encoding;
  Form form = Form::interleaved;
  std::size_t bytes = 1;             ///< a pixel
  std::array<std::size_t, 3> rgb{};  ///< interleaved: the bytes of red, green and blue
  BayerPattern pattern{};            ///< bayer
  std::size_t luma = 0;              ///< luma_chroma: the byte of a pair's first brightness
  PixelKind kind = PixelKind::colors;
};

constexpr Layout interleaved(std::string_view encoding, std::size_t bytes,
                             std::array<std::size_t, 3> rgb) {
  return {.encoding = encoding,
          .bytes = bytes,
          .rgb = rgb,
          .kind = bytes == 1 ? PixelKind::grey : PixelKind::colors};
}
constexpr Layout bayer(std::string_view encoding, std::size_t column, std::size_t row) {
  return {.encoding = encoding, .form = Form::bayer, .pattern = {column, row}};
}
constexpr Layout luma_chroma(std::string_view encoding, std::size_t luma) {
  return {.encoding = encoding, .form = Form::luma_chroma, .bytes = 2, .luma = luma};
}

constexpr std::array kLayouts = {interleaved("rgb8", 3, {0, 1, 2}),
                                 interleaved("rgba8", 4, {0, 1, 2}),
                                 interleaved("bgr8", 3, {2, 1, 0}),
                                 interleaved("bgra8", 4, {2, 1, 0}),
                                 interleaved("8UC3", 3, {2, 1, 0}),
                                 interleaved("8UC4", 4, {2, 1, 0}),
                                 interleaved("mono8", 1, {0, 0, 0}),
                                 interleaved("8UC1", 1, {0, 0, 0}),
                                 bayer("bayer_rggb8", 0, 0),
                                 bayer("bayer_bggr8", 1, 1),
                                 bayer("bayer_gbrg8", 0, 1),
                                 bayer("bayer_grbg8", 1, 0),
                                 luma_chroma("uyvy", 1),
                                 luma_chroma("yuv422", 1),
                                 luma_chroma("yuyv", 0),
                                 luma_chroma("yuv422_yuy2", 0)};

const Layout* find_layout(std::string_view encoding) {
  const auto found = std::ranges::find(kLayouts, encoding, &Layout::encoding);
  return found == kLayouts.end() ? nullptr : &*found;
}

void require_whole(const Image& image, const Layout& layout) {
  const std::size_t row = layout.bytes * image.width;
  if (image.step < row || image.data.size() < std::size_t{image.step} * (image.height - 1) + row) {
    throw ImageError(
        "the " + std::to_string(image.data.size()) + " bytes of the image in rows of " +
        std::to_string(image.step) + " are fewer than " + std::to_string(image.width) + " x " +
        std::to_string(image.height) + " pixels of the encoding '" + image.encoding + "' take");
  }
  const bool pairs = layout.form == Form::luma_chroma && image.width % 2 != 0;
  if (pairs || (layout.form == Form::bayer && std::min(image.width, image.height) < 2)) {
    throw ImageError("an image of the encoding '" + image.encoding + "' cannot have " +
                     std::to_string(image.width) + " x " + std::to_string(image.height) +
                     " pixels");
  }
}

uint8_t rounded(double value) {
  return static_cast<uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
}

/// ITU-R BT.601: brightness from 16 to 235, the differences around 128.
std::array<uint8_t, 3> rgb_of(uint8_t luma, uint8_t blue, uint8_t red) {
  const double y = 255.0 / 219.0 * (luma - 16.0);
  const double b = 255.0 / 224.0 * (blue - 128.0);
  const double r = 255.0 / 224.0 * (red - 128.0);
  constexpr double kRed = 0.299;
  constexpr double kGreen = 0.587;
  constexpr double kBlue = 0.114;
  const double from_red = 2.0 * (1.0 - kRed);
  const double from_blue = 2.0 * (1.0 - kBlue);
  return {rounded(y + from_red * r),
          rounded(y - (kBlue * from_blue * b + kRed * from_red * r) / kGreen),
          rounded(y + from_blue * b)};
}

/// `bytes` are those of the row's pixels, three a pixel go to `into`.
void read_row(std::span<const uint8_t> bytes, const Layout& layout, uint8_t* into) {
  if (layout.form == Form::interleaved) {
    for (std::size_t i = 0; i < bytes.size(); i += layout.bytes) {
      for (const std::size_t color : layout.rgb) {
        *into++ = bytes[i + color];
      }
    }
    return;
  }
  const std::size_t chroma = 1 - layout.luma;
  for (std::size_t i = 0; i < bytes.size(); i += 4) {
    for (const std::size_t pixel : {std::size_t{0}, std::size_t{2}}) {
      const auto rgb =
          rgb_of(bytes[i + layout.luma + pixel], bytes[i + chroma], bytes[i + chroma + 2]);
      into = std::ranges::copy(rgb, into).out;
    }
  }
}

}  // namespace

PixelKind kind_of_pixels(std::string_view encoding) {
  const Layout* const layout = find_layout(encoding);
  return layout == nullptr ? PixelKind::none : layout->kind;
}

ColorImage to_color(const Image& image) {
  const Layout* const layout = find_layout(image.encoding);
  if (layout == nullptr) {
    throw ImageError("images of the encoding '" + image.encoding +
                     "' are not read as colours: rgb8, bgr8, rgba8, bgra8, mono8, bayer_rggb8 and "
                     "its like, yuv422 and yuyv are");
  }
  require_image_size(image.width, image.height);
  require_whole(image, *layout);
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(image.data.data()),
                                       image.data.size());
  if (layout->form == Form::bayer) {
    return demosaic(bytes, image.width, image.height, image.step, layout->pattern);
  }
  ColorImage colors{.width = image.width, .height = image.height};
  colors.rgb.resize(3 * colors.width * colors.height);
  for (std::size_t row = 0; row < colors.height; ++row) {
    read_row(bytes.subspan(row * image.step, layout->bytes * colors.width), *layout,
             colors.rgb.data() + 3 * row * colors.width);
  }
  return colors;
}

ColorImage to_color(const CompressedImage& image) {
  return decode_image(image.data);
}

bool is_depth(const CompressedImage& image) {
  return image.format.find("compressedDepth") != std::string::npos ||
         image.format.starts_with("16UC1") || image.format.starts_with("32FC1") ||
         image.format.starts_with("mono16");
}

}  // namespace adit::ros
