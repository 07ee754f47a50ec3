// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "adit/tools/cameras/color_image.hpp"

namespace adit {

/// Where the red pixels are, of each 2 x 2; the blue one lies diagonally, the others are green.
struct BayerPattern {
  std::size_t red_column = 0;
  std::size_t red_row = 0;
};

/// What each pixel did not see is the mean of its neighbours that did. `values` are rows of `step`
/// bytes, at least two rows and columns.
ColorImage demosaic(std::span<const uint8_t> values, std::size_t width, std::size_t height,
                    std::size_t step, const BayerPattern& pattern);

}  // namespace adit
