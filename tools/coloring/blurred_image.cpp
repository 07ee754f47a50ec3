// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/coloring/blurred_image.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace adit {
namespace {

/// Means along lines of `length` values, `step` values apart.
void blur_line(const uint8_t* from, uint8_t* to, std::size_t length, std::size_t step,
               std::size_t radius) {
  uint32_t sum = 0;
  std::size_t first = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < length; ++i) {
    for (; end < std::min(length, i + radius + 1); ++end) {
      sum += from[end * step];
    }
    for (; first + radius < i; ++first) {
      sum -= from[first * step];
    }
    const auto count = static_cast<uint32_t>(end - first);
    to[i * step] = static_cast<uint8_t>((sum + count / 2) / count);
  }
}

}  // namespace

ColorImage blurred(const ColorImage& image, int radius) {
  const auto reach = static_cast<std::size_t>(std::max(radius, 0));
  ColorImage across = image;
  ColorImage both = image;
  for (std::size_t v = 0; v < image.height; ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = 3 * v * image.width + k;
      blur_line(image.rgb.data() + at, across.rgb.data() + at, image.width, 3, reach);
    }
  }
  for (std::size_t u = 0; u < 3 * image.width; ++u) {
    blur_line(across.rgb.data() + u, both.rgb.data() + u, image.height, 3 * image.width, reach);
  }
  return both;
}

}  // namespace adit
