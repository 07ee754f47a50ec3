// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/mapping/map_store.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/slam/submaps/submap_cache.hpp"

namespace adit {

/// T_map_lidar of every sweep of a map, or of one session of it, in the order of keyframes. `file`
/// is for messages. Throws InputError where a submap is damaged.
std::vector<StampedPose> map_trajectory(const MapStore& map, const std::filesystem::path& file,
                                        std::optional<SessionId> session = {});

/// Where in that trajectory a part begins that nothing ties to what comes before; the first is none
/// of them.
std::vector<std::size_t> map_parts(const MapStore& map, const std::filesystem::path& file,
                                   std::optional<SessionId> session = {});

/// A stored submap, the same from a cache, and one without its points. Throw InputError where it is
/// damaged.
KeyframeSubmap load_submap(const MapStore& map, NodeId keyframe, const std::filesystem::path& file);
/// The same, of submaps that are kept.
std::shared_ptr<const KeyframeSubmap> load_submap(SubmapCache& cache, NodeId keyframe,
                                                  const std::filesystem::path& file);
/// The sweeps of a submap alone, without its points.
KeyframeSubmap load_sweeps(const MapStore& map, NodeId keyframe, const std::filesystem::path& file);

}  // namespace adit
