// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/map_trajectory.hpp"

#include <string>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

/// What `read` gives, with the file's name where it is damaged.
template <class Read>
auto named(const std::filesystem::path& file, NodeId keyframe, const Read& read) {
  try {
    return read();
  } catch (const SubmapDamaged& damage) {
    throw InputError(file, {}, "submap " + std::to_string(keyframe) + " " + damage.what(),
                     "`adit check` says what else is wrong");
  }
}

}  // namespace

std::vector<StampedPose> map_trajectory(const MapStore& map, const std::filesystem::path& file) {
  std::vector<StampedPose> poses;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    for (const SubmapSweep& sweep : load_sweeps(map, keyframe.id, file).sweeps) {
      poses.push_back(
          {.stamp = sweep.stamp, .pose = keyframe.T_map_keyframe * sweep.T_keyframe_lidar});
    }
  }
  return poses;
}

std::vector<std::size_t> map_parts(const MapStore& map, const std::filesystem::path& file) {
  const PoseGraph graph = map.graph();
  const GraphComponents tied = connected_components(graph);
  std::vector<std::size_t> parts;
  std::size_t poses = 0;
  for (std::size_t i = 0; i < graph.nodes().size(); ++i) {
    if (i > 0 && tied.component_of[i] != tied.component_of[i - 1]) {
      parts.push_back(poses);
    }
    poses += load_sweeps(map, graph.nodes()[i].id, file).sweeps.size();
  }
  return parts;
}

KeyframeSubmap load_submap(const MapStore& map, NodeId keyframe,
                           const std::filesystem::path& file) {
  return named(file, keyframe, [&] { return decode(map.submap(keyframe)); });
}

std::shared_ptr<const KeyframeSubmap> load_submap(SubmapCache& cache, NodeId keyframe,
                                                  const std::filesystem::path& file) {
  return named(file, keyframe, [&] { return cache.get(keyframe); });
}

KeyframeSubmap load_sweeps(const MapStore& map, NodeId keyframe,
                           const std::filesystem::path& file) {
  return named(file, keyframe, [&] { return decode_sweeps(map.chunk(keyframe, kSweepChunk)); });
}

}  // namespace adit
