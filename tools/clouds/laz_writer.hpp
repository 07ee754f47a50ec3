// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/las_layout.hpp"
#include "adit/tools/clouds/laz_format.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

/// How such points are packed.
void add_laz_record(LasRecords& records, uint32_t chunk_points, const LasPointLayout& layout);

/// What a table says of each chunk.
enum class LazTable { sizes, points_and_sizes };

/// Writes the points of a LAZ file: chunks, packed on all processors, and the table of their sizes.
class LazChunkWriter {
 public:
  /// `begin`: the byte of the file that comes next. `file` must outlive it.
  LazChunkWriter(OutputFile& file, uint64_t begin, const LasPointLayout& layout);

  /// Packs the points of each, at least one, into a chunk of its own.
  std::vector<LazChunk> write(std::span<const std::string_view> chunks);
  /// Writes the table. Returns the byte behind it.
  uint64_t finish(LazTable table);

 private:
  OutputFile* file_;
  uint64_t begin_;
  uint64_t at_;
  LasPointLayout layout_;
  std::vector<LazChunk> chunks_{};
};

}  // namespace adit
