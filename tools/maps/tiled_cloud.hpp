// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "adit/slam/core/types.hpp"
#include "adit/tools/maps/map_database.hpp"

namespace adit {

/// The cloud of a map with one point a voxel of `resolution` (m): the first, in the order of
/// keyframes. It comes tile by tile, so that memory holds the voxels of one tile and submaps of up
/// to `submap_bytes`, whatever the map's size. Points are in the map's frame, m. Throws InputError
/// where the map is damaged.
void visit_thinned_cloud(const MapDatabase& map, double resolution, uint64_t submap_bytes,
                         const std::function<void(std::span<const Point>)>& take);

}  // namespace adit
