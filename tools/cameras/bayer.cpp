// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cameras/bayer.hpp"

#include <array>

namespace adit {

ColorImage demosaic(std::span<const uint8_t> values, std::size_t width, std::size_t height,
                    std::size_t step, const BayerPattern& pattern) {
  ColorImage image{.width = width, .height = height};
  image.rgb.resize(3 * width * height);
  std::size_t into = 0;
  for (std::size_t row = 0; row < height; ++row) {
    // Mirrored at the border, which keeps the pattern.
    const std::size_t above = row > 0 ? row - 1 : 1;
    const std::size_t below = row + 1 < height ? row + 1 : height - 2;
    for (std::size_t column = 0; column < width; ++column) {
      const std::size_t left = column > 0 ? column - 1 : 1;
      const std::size_t right = column + 1 < width ? column + 1 : width - 2;
      const auto at = [&](std::size_t r, std::size_t c) -> unsigned {
        return values[r * step + c];
      };
      const unsigned here = at(row, column);
      const unsigned across = (at(row, left) + at(row, right) + 1) / 2;
      const unsigned along = (at(above, column) + at(below, column) + 1) / 2;
      const unsigned beside =
          (at(row, left) + at(row, right) + at(above, column) + at(below, column) + 2) / 4;
      const unsigned corners =
          (at(above, left) + at(above, right) + at(below, left) + at(below, right) + 2) / 4;
      const bool in_red_row = row % 2 == pattern.red_row;
      const bool in_red_column = column % 2 == pattern.red_column;
      std::array<unsigned, 3> rgb{};
      if (in_red_row == in_red_column) {  // a red or a blue one
        rgb = in_red_row ? std::array{here, beside, corners} : std::array{corners, beside, here};
      } else {
        rgb = in_red_row ? std::array{across, here, along} : std::array{along, here, across};
      }
      for (const unsigned value : rgb) {
        image.rgb[into++] = static_cast<uint8_t>(value);
      }
    }
  }
  return image;
}

}  // namespace adit
