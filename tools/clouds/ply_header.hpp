// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {

enum class PlyFormat { ascii, little_endian, big_endian };

/// A number, or where `list_count` is set a list: a count of that type, then so many numbers.
struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::f32;
  std::optional<ScalarType> list_count;
};

/// `count` records of the same properties.
struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  std::size_t smallest_record() const;  ///< bytes in binary, lists empty
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  ///< size of the header itself
  uint64_t lines = 0;
  CloudReading reading{};  ///< what the file does not say
};

/// Throws InputError with the line that is wrong.
PlyHeader parse_ply_header(const std::filesystem::path& file, std::string_view content);

}  // namespace adit
