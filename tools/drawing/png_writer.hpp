// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace adit {

using Color = std::array<uint8_t, 3>;  ///< red, green, blue

/// A picture, row by row from the top.
struct Image {
  Image(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  Color& at(int x, int y) { return pixels[index(x, y)]; }
  const Color& at(int x, int y) const { return pixels[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }

  int width;   ///< px
  int height;  ///< px
  std::vector<Color> pixels;
};

/// The picture as PNG: all bytes of such a file.
std::string png_bytes(const Image& image);

/// The same of red, green, blue and opacity a pixel, row by row from the top.
std::string png_bytes_with_alpha(int width, int height, std::span<const uint8_t> pixels);

/// Writes the picture as PNG. Throws OutputError.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace adit
