// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "adit/tools/support/input_error.hpp"

namespace adit {

/// An image of one channel, row by row.
struct DepthPng {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<uint16_t> values;
};

/// Decodes a PNG of 16-bit greys, interlaced or not; `file` is for messages. Throws InputError:
/// damaged, cut off, of another kind, or more than 4096 pixels wide or high.
DepthPng parse_depth_png(const std::filesystem::path& file, std::string_view content);

}  // namespace adit
