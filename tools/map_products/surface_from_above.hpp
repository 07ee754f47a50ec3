// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The surface of a map as it is seen from above: at each place the highest one whose upper side was
// seen (docs/theory/coloring.md). Ceilings, which show their lower side, hide no floor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

/// Places of the surface in squares of a cell are kPlacesAcross * kPlacesAcross, evenly spread.
inline constexpr int64_t kPlacesAcross = 2;

/// A part of a surface.
struct SurfacePart {
  /// Places that have a surface, row by row of cells and cell by cell, in the product's coordinates
  /// and in the map. Their keyframe, time and session are not known.
  std::span<CloudPoint> points;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< of them, map frame, m
};
using TakeSurface =
    std::function<void(const SurfacePart& part, std::size_t done, std::size_t total)>;

/// Visits the surface of the points that are wanted, without what moves, a square of at most some
/// 26 m at a time, so that squares that follow each other are mostly neighbours. A cell of `cell`
/// (m), with borders at multiples of it, is never in two of them. `done` of `total` squares are
/// finished, those without a surface included. Throws InputError where the map
/// is damaged.
void visit_surface_from_above(const MapDatabase& map, const ProductCoordinates& coordinates,
                              const CloudSelection& selection, double cell, uint64_t submap_bytes,
                              const TakeSurface& take);

}  // namespace adit
