// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace adit {

/// A picture, row by row from the top.
struct Image {
  Image(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  std::array<uint8_t, 3>& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }

  int width;                                   ///< px
  int height;                                  ///< px
  std::vector<std::array<uint8_t, 3>> pixels;  ///< red, green, blue
};

/// Writes the picture as PNG. Throws OutputError.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace adit
