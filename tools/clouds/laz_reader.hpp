// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace adit {

/// Where the points of a LAZ file are and what their formats are, as its LAS header says.
struct LazSource {
  uint64_t begin = 0;  ///< byte of the points
  uint64_t points = 0;
  std::size_t format = 0;  ///< of a point, 0 to 10
  std::size_t point_bytes = 0;
  std::span<const std::byte> records{};  ///< all variable length records
};

struct LazPoints {
  std::string bytes{};          ///< of whole points, as a LAS file has them
  std::size_t point_bytes = 1;  ///< of each: of formats 6 to 10 the first 30 and colours
  std::string fault{};          ///< what is damaged; empty: nothing
};

/// The points of a LAZ file, unpacked on all processors, of all whole chunks in order. Where there
/// is none, the fault says why.
LazPoints unpack_laz(std::span<const std::byte> file, const LazSource& source);

}  // namespace adit
