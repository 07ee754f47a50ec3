// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Words and scale bars on pictures, in letters of 5 by 7 dots: no font has to be there, and the
// bytes are the same everywhere.
#pragma once

#include <string_view>

#include <Eigen/Core>

#include "adit/tools/drawing/png_writer.hpp"

namespace adit {

/// Pixels that a dot of a letter takes across.
inline constexpr int kLetterDot = 2;

/// How wide a text becomes (px), and how high any is.
int text_width_px(std::string_view text);
int text_height_px();

/// Letters, all as small ones, digits and some signs; others are blanks. `at` is the upper left
/// corner. What lies beyond the image is left out.
void write_text(Image& image, const Eigen::Vector2i& at, std::string_view text, const Color& color);

/// A filled rectangle, cut at the image's edges.
void fill(Image& image, const Eigen::Vector2i& corner, const Eigen::Vector2i& size,
          const Color& color);

/// A bar of a round length with its metres above, on a light ground; `right_end` is its right end.
void draw_scale_bar(Image& image, const Eigen::Vector2i& right_end, double metres_per_px);

}  // namespace adit
