// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a map is expected in another one, by what is known of both in the world.
#pragma once

#include <cstddef>

#include "adit/slam/core/config.hpp"
#include "adit/slam/mapping/stored_map.hpp"

namespace adit {

/// The later map, whose nodes are the graph's from `earlier_nodes` on, goes to where it is expected
/// in the earlier one, and an edge of the kind `start` ties it there until loops do: by the places
/// of both in the world or, where it has none, by its fixes. False: nothing says where that is.
bool place_in_earlier(PoseGraph& graph, std::size_t earlier_nodes, const Georeference& earlier,
                      const StoredMap& later, const GnssConfig& gnss);

/// The graph without what was only expected.
PoseGraph measured_alone(const PoseGraph& graph);

}  // namespace adit
