// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Images of a camera as JPEG, for tests of the readers.
#pragma once

#include <turbojpeg.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "adit/tools/cameras/color_image.hpp"

namespace adit::test {

/// Smooth colours that differ from pixel to pixel and from `shade` to `shade`, 0 to 255.
inline ColorImage color_picture(std::size_t width, std::size_t height, unsigned shade = 0) {
  ColorImage image{.width = width, .height = height};
  for (std::size_t row = 0; row < height; ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      image.rgb.push_back(static_cast<uint8_t>(255 * column / width));
      image.rgb.push_back(static_cast<uint8_t>(255 * row / height));
      image.rgb.push_back(static_cast<uint8_t>(shade));
    }
  }
  return image;
}

/// The picture as JPEG, with full or half resolution of the colours, or without them.
inline std::string jpeg_bytes(const ColorImage& image, int subsampling = TJSAMP_444,
                              int flags = 0) {
  constexpr int kQuality = 95;
  const tjhandle encoder = tjInitCompress();
  unsigned char* packed = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(encoder, image.rgb.data(), static_cast<int>(image.width), 0,
                                 static_cast<int>(image.height), TJPF_RGB, &packed, &size,
                                 subsampling, kQuality, flags);
  const std::string bytes = failed == 0 ? std::string(packed, packed + size) : std::string();
  tjFree(packed);
  tjDestroy(encoder);
  if (bytes.empty()) {
    throw std::runtime_error("tjCompress2 failed");
  }
  return bytes;
}

}  // namespace adit::test
