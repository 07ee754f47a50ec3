// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace adit {

/// The check sum that MCAP (and zlib, PNG) calls CRC-32: reflected polynomial 0xedb88320. `before`
/// is the sum of the bytes before these, so that pieces can be added up.
inline uint32_t crc32(std::span<const std::byte> bytes, uint32_t before = 0) {
  // Eight tables: eight bytes a turn. Table 0 takes one byte; table k one that lies k further on.
  static constexpr auto kTables = [] {
    std::array<std::array<uint32_t, 256>, 8> tables{};
    for (uint32_t i = 0; i < 256; ++i) {
      uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) {
        value = (value >> 1U) ^ ((value & 1U) != 0 ? 0xedb88320U : 0U);
      }
      tables[0][i] = value;
    }
    for (std::size_t k = 1; k < 8; ++k) {
      for (std::size_t i = 0; i < 256; ++i) {
        const uint32_t value = tables[k - 1][i];
        tables[k][i] = (value >> 8U) ^ tables[0][value & 0xffU];
      }
    }
    return tables;
  }();
  uint32_t sum = ~before;
  const auto at = [&](std::size_t i) { return std::to_integer<uint32_t>(bytes[i]); };
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    sum ^= at(i) | at(i + 1) << 8U | at(i + 2) << 16U | at(i + 3) << 24U;
    sum = kTables[7][sum & 0xffU] ^ kTables[6][sum >> 8U & 0xffU] ^ kTables[5][sum >> 16U & 0xffU] ^
          kTables[4][sum >> 24U] ^ kTables[3][at(i + 4)] ^ kTables[2][at(i + 5)] ^
          kTables[1][at(i + 6)] ^ kTables[0][at(i + 7)];
  }
  for (; i < bytes.size(); ++i) {
    sum = (sum >> 8U) ^ kTables[0][(sum ^ at(i)) & 0xffU];
  }
  return ~sum;
}

}  // namespace adit
