// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The octree of a COPC file. A point is in the coarsest node in which no other point has its cell
// yet, of 128 a side; nodes with few points below them keep all of them. The cube begins a third
// of a step below the lowest point, so that no half, quarter and so on of it lies on a point: a
// reader that rounds finds each point in its node.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/las_layout.hpp"
#include "adit/tools/support/scratch_file.hpp"

namespace adit {

/// A node: level 0 is the root, level n has 2^n nodes a side.
struct VoxelKey {
  int32_t level = 0;
  int32_t x = 0;
  int32_t y = 0;
  int32_t z = 0;

  auto operator<=>(const VoxelKey&) const = default;
};

/// The cube of the root.
struct CopcCube {
  static constexpr uint64_t kParts = 3;  ///< of a step

  std::array<int32_t, 3> lowest{};  ///< steps, of the points
  uint64_t side = kParts;           ///< parts of steps

  using Place = std::array<uint64_t, 3>;

  /// A point's place in the cube in parts of steps, by its bytes in a LAS file.
  Place place_of(const char* point) const;
  VoxelKey key_of(const Place& place, int32_t level) const;
  /// Its cell in that node.
  uint32_t cell_of(const Place& place, int32_t level) const;
};
CopcCube cube_of(const LasExtent& extent);
inline constexpr uint32_t kCopcCells = 128;  ///< a side of a node

struct CopcNode {
  VoxelKey key{};
  std::string points{};  ///< as a LAS file has them
};
using TakeNodes = std::function<void(std::span<const CopcNode>)>;

/// Points of a LAS file as adit writes it.
struct CopcPoints {
  const ScratchFile* file = nullptr;
  std::size_t point_bytes = 0;
};

/// How much is handled at a time.
struct CopcLimits {
  /// Points of a part of the octree that is in memory at a time: 72 MB, with colours 84 MB.
  uint64_t part = 2'000'000;
  /// Points that a node keeps without nodes below it, as many as a chunk of other LAZ files.
  uint64_t node = 50'000;
};

/// All nodes with points, each once, some at a time, always in the same order.
void visit_copc_nodes(const CopcPoints& points, const CopcCube& cube, const CopcLimits& limits,
                      const TakeNodes& take);

}  // namespace adit
