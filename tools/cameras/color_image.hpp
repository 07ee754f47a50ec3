// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace adit {

/// What a camera saw: red, green and blue of each pixel, row by row from the upper left.
struct ColorImage {
  std::size_t width = 0;       ///< pixels
  std::size_t height = 0;      ///< pixels
  std::vector<uint8_t> rgb{};  ///< three a pixel
};

}  // namespace adit
