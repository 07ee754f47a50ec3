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

std::vector<MapKeyframe> keyframes_of(const MapStore& map, std::optional<SessionId> session) {
  std::vector<MapKeyframe> keyframes = map.keyframes();
  if (session) {
    std::erase_if(keyframes, [&](const MapKeyframe& one) { return one.session != *session; });
  }
  return keyframes;
}

}  // namespace

std::vector<StampedPose> map_trajectory(const MapStore& map, const std::filesystem::path& file,
                                        std::optional<SessionId> session) {
  std::vector<StampedPose> poses;
  for (const MapKeyframe& keyframe : keyframes_of(map, session)) {
    for (const SubmapSweep& sweep : load_sweeps(map, keyframe.id, file).sweeps) {
      poses.push_back(
          {.stamp = sweep.stamp, .pose = keyframe.T_map_keyframe * sweep.T_keyframe_lidar});
    }
  }
  return poses;
}

std::vector<std::size_t> map_parts(const MapStore& map, const std::filesystem::path& file,
                                   std::optional<SessionId> session) {
  const PoseGraph graph = map.graph();
  const GraphComponents tied = connected_components(graph);
  std::vector<std::size_t> parts;
  std::size_t poses = 0;
  std::optional<std::size_t> before;
  for (const MapKeyframe& keyframe : keyframes_of(map, session)) {
    const std::size_t part = tied.component_of[graph.index_of(keyframe.id)];
    if (before && part != *before) {
      parts.push_back(poses);
    }
    before = part;
    poses += load_sweeps(map, keyframe.id, file).sweeps.size();
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
