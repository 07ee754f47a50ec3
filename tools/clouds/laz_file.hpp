// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The frame of LAZ files: the record that says how points are packed, the chunks, and the table of
// their sizes. Chunks are packed and unpacked on all processors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/las_layout.hpp"
#include "adit/tools/clouds/laz_chunk.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

/// Points of a chunk that other programs write, too (LASzip).
inline constexpr uint32_t kLazChunkPoints = 50'000;
/// In the place of that: chunks have a number of points each.
inline constexpr uint32_t kLazAnyPoints = 0xffffffffU;

/// How points of format 6 with so many extra bytes are packed.
void add_laz_record(LasRecords& records, uint32_t chunk_points, std::size_t extra_bytes);

struct LazChunk {
  uint64_t begin = 0;  ///< byte of the file
  uint64_t bytes = 0;
  uint64_t points = 0;
};

/// What a table says of each chunk.
enum class LazTable { sizes, points_and_sizes };

/// Writes the points of a LAZ file.
class LazChunkWriter {
 public:
  /// `begin`: the byte of the file that comes next. `file` must outlive it.
  LazChunkWriter(OutputFile& file, uint64_t begin, std::size_t point_bytes);

  /// Packs the points of each, at least one, into a chunk of its own.
  std::vector<LazChunk> write(std::span<const std::string_view> chunks);
  /// Writes the table. Returns the byte behind it.
  uint64_t finish(LazTable table);

 private:
  OutputFile* file_;
  uint64_t begin_;
  uint64_t at_;
  std::size_t point_bytes_;
  std::vector<LazChunk> chunks_{};
};

/// Where the points of a LAZ file are and what their formats are, as its LAS header says.
struct LazSource {
  uint64_t begin = 0;  ///< byte of the points
  uint64_t points = 0;
  std::size_t point_bytes = 0;
  std::span<const std::byte> records{};  ///< all variable length records
};

struct LazPoints {
  std::string bytes{};  ///< of whole points, as a LAS file has them up to their GPS time
  std::string fault{};  ///< what is damaged; empty: nothing
};

/// The points of a LAZ file, of all whole chunks in order. Where there is none, the fault says why.
LazPoints unpack_laz(std::span<const std::byte> file, const LazSource& source);

}  // namespace adit
