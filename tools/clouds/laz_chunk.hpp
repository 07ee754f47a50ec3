// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A chunk of points of LAS formats 6 to 10 as LAZ files have it: "LASzip for LAS 1.4 (native
// extension)", LAStools' LASzip/design/specification.rst, items POINT14, RGB14 and BYTE14, version
// 3. Each attribute has a layer of its own, so that the places of points can be read without their
// colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "adit/tools/clouds/las_layout.hpp"

namespace adit {

/// Packs points of format 6 or, with colours, 7. At least one point; where there are colours or
/// extra bytes, all of scanner channel 0. `points` is their bytes as a LAS file has them.
std::string pack_laz_chunk(std::string_view points, const LasPointLayout& layout);

/// What lies between the bytes of a chunk's points.
struct LazChunkLayout {
  std::size_t point_bytes = kLas6Bytes;
  std::size_t layers = 9;  ///< of all items
  bool colored = false;    ///< formats 7, 8 and 10

  /// Of what is unpacked: the first 30 bytes of each point, and its red, green and blue.
  std::size_t unpacked_bytes() const { return kLas6Bytes + (colored ? kLasColorBytes : 0); }
};

struct UnpackedChunk {
  std::string points{};   ///< as a LAS file has them
  bool is_whole = false;  ///< neither cut off nor damaged, as far as it can be seen
};

/// The first bytes of each of `count` points, as many as the layout says: what formats 6 to 10 have
/// in common, and colours.
UnpackedChunk unpack_laz_chunk(std::span<const std::byte> chunk, std::size_t count,
                               const LazChunkLayout& layout);

}  // namespace adit
