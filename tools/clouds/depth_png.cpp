// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/depth_png.hpp"

#include <optional>

#include "adit/tools/clouds/png_decoder.hpp"

namespace adit {

DepthPng parse_depth_png(const std::filesystem::path& file, std::string_view content) {
  constexpr std::size_t kMostPixels = 4096;  // in each direction
  std::optional<PngDecoder> png;
  try {
    png.emplace(content, kMostPixels);
    if (!png->is_grey16()) {
      throw InputError(file, {}, "it is a PNG of another kind",
                       "Depth images have one channel of 16 bits");
    }
    return {.width = png->width(), .height = png->height(), .values = png->read_grey16()};
  } catch (const ImageError& error) {
    throw InputError(file, Place::byte(png ? png->offset() : 0), error.what(),
                     "The image is damaged or cut off: copy it again");
  }
}

}  // namespace adit
