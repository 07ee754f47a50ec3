// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The frame of LAZ files: a record says how points are packed, and points lie in chunks.
#pragma once

#include <cstdint>
#include <string_view>

namespace adit {

/// Points of a chunk that other programs write, too (LASzip).
inline constexpr uint32_t kLazChunkPoints = 50'000;
/// In the place of that: chunks have a number of points each.
inline constexpr uint32_t kLazAnyPoints = 0xffffffffU;

/// The record that says how points are packed.
inline constexpr std::string_view kLazUser = "laszip encoded";
inline constexpr uint16_t kLazRecord = 22204;
inline constexpr uint16_t kPointwiseChunks = 2;
inline constexpr uint16_t kLayeredChunks = 3;

/// Kinds of items of a point.
enum class LazItemKind : uint16_t {
  bytes = 0,
  point10 = 6,
  time11 = 7,
  color12 = 8,
  wave13 = 9,
  point14 = 10,
  color14 = 11,
  color_nir14 = 12,
  wave14 = 13,
  bytes14 = 14
};

struct LazItem {
  LazItemKind kind = LazItemKind::bytes;
  uint16_t bytes = 0;
  uint16_t version = 0;
};

struct LazChunk {
  uint64_t begin = 0;  ///< byte of the file
  uint64_t bytes = 0;
  uint64_t points = 0;
};

}  // namespace adit
