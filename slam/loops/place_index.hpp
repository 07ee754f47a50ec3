// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Finds places by what they look like, wherever the graph believes them to be
// (docs/theory/loops.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernels/places.hpp"
#include "adit/slam/registration/alignment_clouds.hpp"
#include "adit/slam/submaps/place_descriptor.hpp"

namespace adit {

/// An earlier place beside the newest one.
struct SimilarPlace {
  std::size_t place = 0;    ///< its number in the index
  double similarity = 0.0;  ///< 0 to 1: polar bits in common at the best turn
  double yaw = 0.0;         ///< rad, of T_place_newest, to a sector
};

/// How the newest place may lie to an earlier one: in the plane and about the vertical.
struct PlaceGuess {
  std::size_t place = 0;
  Eigen::Isometry3d T_place_newest = Eigen::Isometry3d::Identity();
  double likeness = 0.0;  ///< share of the plan's cells on those of the place
};

/// Places in the order in which they came, numbered from 0. Each call waits for the device.
class PlaceIndex {
 public:
  /// The context must outlive it.
  explicit PlaceIndex(engine::Context& context);

  std::size_t size() const { return sizes_.size(); }

  /// A cloud whose z axis is the vertical becomes the next place; `cell` is the edge of a cell of
  /// its plan, m. Throws engine::OutOfMemory.
  PlaceDescriptor add(const SurfaceCloud& cloud, double cell);
  /// The next place is one that looks like nothing: its vertical is not known.
  void add_unknown();
  /// The next places, as they were described before; nothing: unknown. Only into an empty index.
  /// Throws engine::OutOfMemory.
  void add_described(std::span<const std::optional<PlaceDescriptor>> places);

  /// All places before the newest, in their order; none where that one is unknown, or where too
  /// little stands around it.
  std::vector<SimilarPlace> similar() const;
  /// The best guess for each of these, found by correlating the plans.
  std::vector<PlaceGuess> guesses(std::span<const SimilarPlace> places) const;

 private:
  std::size_t next();

  engine::Context* context_;
  engine::PlaceKernels kernels_;
  std::vector<engine::Buffer> blocks_;
  engine::Buffer record_;                  ///< the newest place's
  std::vector<uint32_t> sizes_;            ///< bits of each polar view
  std::optional<PlaceDescriptor> newest_;  ///< none: unknown
};

}  // namespace adit
