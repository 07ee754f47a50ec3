// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/tools/maps/map_database.hpp"

namespace adit {

/// The loops of a map as an HTML page that needs nothing else: how many with which verdict and why,
/// the graph from above, a table of all, and each as its two submaps laid upon each other, where
/// the odometry alone has them and where they were aligned. Where there are very many of a verdict,
/// an even choice of them is drawn, and the page says so. Throws what the map does, and
/// SubmapDamaged.
std::string loops_page(const MapDatabase& map);

}  // namespace adit
