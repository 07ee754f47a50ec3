// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cameras/image_codec.hpp"

#include <turbojpeg.h>

#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <string_view>

namespace adit {
namespace {

constexpr std::string_view kJpegMagic = "\xff\xd8\xff";
constexpr std::string_view kPngMagic = "\x89PNG\r\n\x1a\n";

bool begins_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

struct Closer {
  void operator()(void* decoder) const { tjDestroy(decoder); }
};
using Decoder = std::unique_ptr<void, Closer>;

/// Bytes between two segments, as some cameras pad their images: no pixel is lost.
bool is_harmless(tjhandle decoder) {
  return tjGetErrorCode(decoder) == TJERR_WARNING &&
         std::string_view(tjGetErrorStr2(decoder)).find("extraneous bytes") !=
             std::string_view::npos;
}

ColorImage decode_jpeg(std::span<const std::byte> bytes) {
  // Each block of 8 x 8 pixels takes a bit at least, and twice as many pixels do no harm.
  constexpr std::size_t kMostPixelsPerByte = 1024;
  const Decoder decoder(tjInitDecompress());
  if (!decoder) {
    throw std::bad_alloc();
  }
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto size = static_cast<unsigned long>(bytes.size());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  if (tjDecompressHeader3(decoder.get(), data, size, &width, &height, &subsampling, &colours) !=
          0 &&
      !is_harmless(decoder.get())) {
    throw ImageError(std::string("it is no JPEG that can be read: ") +
                     tjGetErrorStr2(decoder.get()));
  }
  if (width == 0 || height == 0) {  // tables alone, as the bytes before the image's header are
    throw ImageError("it is no JPEG that can be read: it ends before its image begins");
  }
  ColorImage image{.width = static_cast<std::size_t>(width),
                   .height = static_cast<std::size_t>(height)};
  require_image_size(image.width, image.height);
  if (image.width * image.height > kMostPixelsPerByte * bytes.size()) {
    throw ImageError("it promises " + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels, which " + std::to_string(bytes.size()) + " bytes cannot hold");
  }
  image.rgb.resize(3 * image.width * image.height);
  if (tjDecompress2(decoder.get(), data, size, image.rgb.data(), width, 0, height, TJPF_RGB,
                    TJFLAG_ACCURATEDCT) != 0 &&
      !is_harmless(decoder.get())) {
    throw ImageError(std::string("its pixels cannot be read: ") + tjGetErrorStr2(decoder.get()));
  }
  return image;
}

ColorImage decode_png(std::span<const std::byte> bytes) {
  PngDecoder png({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, kMostImageSide);
  ColorImage image{.width = png.width(), .height = png.height()};
  require_image_size(image.width, image.height);
  image.rgb = png.read_rgb8();
  return image;
}

}  // namespace

void require_image_size(std::size_t width, std::size_t height) {
  if (width == 0 || height == 0 || width > kMostImageSide || height > kMostImageSide ||
      width * height > kMostImagePixels) {
    throw ImageError("the image has " + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels; expected 1 to " + std::to_string(kMostImageSide) +
                     " in each direction, and " + std::to_string(kMostImagePixels) + " at most");
  }
}

bool is_packed_image(std::span<const std::byte> bytes) {
  return begins_with(bytes, kJpegMagic) || begins_with(bytes, kPngMagic);
}

ColorImage decode_image(std::span<const std::byte> bytes) {
  if (begins_with(bytes, kJpegMagic)) {
    return decode_jpeg(bytes);
  }
  if (begins_with(bytes, kPngMagic)) {
    return decode_png(bytes);
  }
  throw ImageError("the image is neither a JPEG nor a PNG");
}

}  // namespace adit
