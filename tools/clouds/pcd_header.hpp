// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {

enum class PcdData { ascii, binary, binary_compressed };

/// One entry of FIELDS: `count` numbers of one type in a row; none where `count` is 0.
struct PcdField {
  std::string name;
  ScalarType type = ScalarType::f32;
  std::size_t count = 1;
  std::size_t offset = 0;  ///< bytes before it in a point

  std::size_t bytes() const { return size_of(type) * count; }
};

/// The text at the start of a PCD file, checked for consistency with itself (not yet with the
/// file's size).
struct PcdHeader {
  std::vector<PcdField> fields;
  uint64_t points = 0;          ///< POINTS, or WIDTH x HEIGHT
  uint64_t other_points = 0;    ///< WIDTH x HEIGHT, where POINTS says otherwise; else as `points`
  std::size_t point_bytes = 0;  ///< sum over all fields
  std::size_t numbers = 0;      ///< a point holds, over all fields
  PcdData data = PcdData::ascii;
  std::size_t bytes = 0;  ///< size of the header itself
  uint64_t lines = 0;
  CloudReading reading{};  ///< what the file does not say
};

/// Keywords and types are read in upper and lower case; COUNT may be missing (1 each), and so may
/// POINTS, or WIDTH and HEIGHT. Throws InputError with the line or the entry that is missing or
/// contradicts another.
PcdHeader parse_pcd_header(const std::filesystem::path& file, std::string_view content);

}  // namespace adit
