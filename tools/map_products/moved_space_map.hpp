// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "adit/slam/submaps/moved_space.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// What has moved anywhere in a map, tile by tile: memory holds submaps of up to `submap_bytes` and
/// the voxels of one tile. Voxels are as large as the submaps' cells, 0.2 m at least. Throws
/// InputError where the map is damaged, engine::Error, and what `progress` does.
MovedSpace find_moved_space(
    const MapDatabase& map, engine::Context& context, uint64_t submap_bytes,
    const std::function<void(std::size_t done, std::size_t total)>& progress);

}  // namespace adit
