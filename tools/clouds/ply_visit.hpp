// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "adit/slam/core/types.hpp"

namespace adit {

/// The points of a PLY that PlyWriter has written, in pieces of at most 65536, so that memory does
/// not grow with the file. Throws InputError where it is not laid out so, or holds fewer points
/// than it says.
class WrittenPly {
 public:
  explicit WrittenPly(std::filesystem::path file);

  uint64_t points() const { return points_; }
  void visit(const std::function<void(std::span<const Point>)>& take) const;

 private:
  std::filesystem::path file_;
  uint64_t begin_ = 0;  ///< byte of the first point
  uint64_t points_ = 0;
};

}  // namespace adit
