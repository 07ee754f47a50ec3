// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// JPEG and PNG to pixels.
#pragma once

#include <cstddef>
#include <span>

#include "adit/tools/cameras/color_image.hpp"
#include "adit/tools/clouds/png_decoder.hpp"

namespace adit {

/// Images with more pixels than these in a direction, or in all, are refused before memory is taken
/// for them. No camera has as many: the largest sensors have 150 million.
inline constexpr std::size_t kMostImageSide = 16384;
inline constexpr std::size_t kMostImagePixels = std::size_t{1} << 28U;

/// Throws ImageError where an image has no pixels, or more than are allowed.
void require_image_size(std::size_t width, std::size_t height);

/// True where the bytes begin as a JPEG or a PNG does.
bool is_packed_image(std::span<const std::byte> bytes);

/// Decodes a JPEG or a PNG, recognised by its first bytes; greys give three equal colours, 16 bits
/// are rounded to 8. Throws ImageError: of another kind, damaged, cut off or too large.
ColorImage decode_image(std::span<const std::byte> bytes);

}  // namespace adit
