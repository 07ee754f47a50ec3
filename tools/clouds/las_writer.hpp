// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "adit/tools/clouds/las_layout.hpp"
#include "adit/tools/clouds/laz_writer.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

enum class LasPacking { none, laz };

/// Writes a cloud of any length as LAS 1.4, point format 6 or with colours 7, or packed as LAZ, as
/// the points come: coordinates in millimetres, ring and keyframe as extra bytes. Same points, same
/// bytes: the date in the header is that of the first point, or 0. Throws OutputError, also for a
/// point too far from the offset.
class LasWriter {
 public:
  LasWriter(std::filesystem::path path, LasHeading heading, LasPacking packing = LasPacking::none);

  void write(std::span<const LasPoint> points);
  void close();  ///< must be called for the file to be whole; the destructor cannot report

  uint64_t count() const { return extent_.points; }

 private:
  std::string header() const;
  /// Writes whole chunks of what waits; `all`: what is left, too.
  void write_chunks(bool all);

  LasHeading heading_;
  LasPointLayout layout_;
  OutputFile file_;
  LasRecords records_{};
  LasExtent extent_{};
  std::optional<LazChunkWriter> chunks_{};
  std::string waiting_{};  ///< points that no chunk has yet
};

}  // namespace adit
