// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "adit/tools/clouds/las_layout.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/scratch_file.hpp"

namespace adit {

/// Writes a cloud of any length as a cloud-optimized point cloud (COPC 1.0, copc.io): a LAZ file
/// whose chunks are the nodes of an octree, so that a reader gets a coarse cloud, or a part of it,
/// without the rest. What LasWriter says holds, too. Points wait in a temporary file beside the
/// file; memory holds one part of them at a time, and the coarse nodes.
class CopcWriter {
 public:
  CopcWriter(std::filesystem::path path, LasHeading heading);

  void write(std::span<const LasPoint> points);
  void close();  ///< makes the octree; must be called for the file to be whole

  uint64_t count() const { return extent_.points; }

 private:
  LasHeading heading_;
  OutputFile file_;
  ScratchFile points_;
  LasExtent extent_{};
  std::string waiting_{};  ///< points that are not in the temporary file yet
};

}  // namespace adit
