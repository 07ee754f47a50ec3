// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A chunk of points of LAS formats 0 to 3 as LAZ files have it: M. Isenburg, "LASzip: lossless
// compression of LiDAR data", PE&RS 79(2), 2013, items POINT10, GPSTIME11, RGB12 and BYTE, version
// 2. They are read alone: what adit writes is of formats 6 and 7.
#pragma once

#include <cstddef>
#include <span>

#include "adit/tools/clouds/laz_chunk.hpp"

namespace adit {

/// What follows the 20 bytes that all points begin with, in this order.
struct PointwiseLayout {
  bool has_time = false;   ///< 8 bytes
  bool has_color = false;  ///< 6 bytes
  std::size_t extra_bytes = 0;
};

/// All bytes of each of `count` points.
UnpackedChunk unpack_pointwise_chunk(std::span<const std::byte> chunk, std::size_t count,
                                     const PointwiseLayout& layout);

}  // namespace adit
