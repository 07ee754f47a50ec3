// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth images as files, put together byte by byte, for tests of the readers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/containers/crc32.hpp"

namespace adit::test {

/// In network byte order.
inline std::string big_endian(uint32_t value, std::size_t bytes = 4) {
  std::string text;
  for (std::size_t i = bytes; i-- > 0;) {
    text += static_cast<char>(value >> (8U * i) & 0xffU);
  }
  return text;
}

inline std::string png_chunk(const std::string& name, const std::string& data) {
  const std::string summed = name + data;
  return big_endian(static_cast<uint32_t>(data.size())) + summed +
         big_endian(crc32(std::as_bytes(std::span(summed))));
}

/// A PNG of 16-bit greys; stored, so less than 64 KiB. `kind` is the bits a sample and the type of
/// colour.
inline std::string depth_png(uint32_t width, const std::vector<uint16_t>& values,
                             std::string_view kind = {"\x10\x00", 2}) {
  std::string rows;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % width == 0) {
      rows += '\2';  // each row is stored as its difference from the one above
    }
    const unsigned value = values[i];
    const unsigned above = i < width ? 0U : values[i - width];
    for (const unsigned shift : {8U, 0U}) {
      const unsigned difference = (value >> shift & 0xffU) - (above >> shift & 0xffU);
      rows += static_cast<char>(difference & 0xffU);
    }
  }
  const auto size = static_cast<uint32_t>(rows.size());
  const auto low_first = [](uint32_t v) {
    return std::string{static_cast<char>(v & 0xffU), static_cast<char>(v >> 8U & 0xffU)};
  };
  uint32_t a = 1;
  uint32_t b = 0;
  for (const char c : rows) {
    a = (a + static_cast<uint8_t>(c)) % 65521U;
    b = (b + a) % 65521U;
  }
  const std::string packed =
      "\x78\x01\x01" + low_first(size) + low_first(~size) + rows + big_endian(b << 16U | a);
  const std::string head = big_endian(width) +
                           big_endian(static_cast<uint32_t>(values.size() / width)) +
                           std::string(kind) + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", head) + png_chunk("IDAT", packed) +
         png_chunk("IEND", "");
}

}  // namespace adit::test
