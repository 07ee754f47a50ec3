// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// The loops of a map as an HTML page that needs nothing else: how many with which verdict and why,
/// the graph from above, a table of all, and each as its two submaps laid upon each other: before,
/// where the odometry alone has them, after, where the map has them, and where they were aligned if
/// that is somewhere else. Those of `shown` are drawn, by their ids; without any, of each verdict
/// an even choice of at most 60, and the page says so. Throws what the map does, and SubmapDamaged.
std::string loops_page(const MapDatabase& map, std::span<const int64_t> shown = {});

}  // namespace adit
