// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_edits/loops_picture.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/loops/loop_reason.hpp"
#include "adit/tools/drawing/map_picture.hpp"
#include "adit/tools/drawing/markup.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostKeyframes = 4000;
constexpr std::size_t kMostLinks = 3000;

/// So many of `count`, evenly chosen, are those whose number is a multiple of this.
std::size_t stride_of(std::size_t count, std::size_t most) {
  return std::max<std::size_t>((count + most - 1) / most, 1);
}

}  // namespace

std::string loop_counts(std::span<const LoopCandidate> loops) {
  std::map<std::string, std::size_t> counts;
  for (const LoopCandidate& loop : loops) {
    const bool plain = loop.reason.empty() || loop.reason == to_string(LoopReason::none);
    ++counts[std::string(to_string(loop.verdict)) + (plain ? "" : ": " + loop.reason)];
  }
  std::string text = "<dl>";
  for (const auto& [what, count] : counts) {
    text += fmt::format("<dt>{}</dt><dd>{}</dd>", escape_markup(what), count);
  }
  return text + "</dl>\n";
}

std::string loops_from_above(const MapDatabase& map, const PoseGraph& graph,
                             std::span<const LoopCandidate> loops) {
  PictureGraph drawn;
  std::vector<StampedPose> path;
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  for (std::size_t i = 0; i < keyframes.size(); i += stride_of(keyframes.size(), kMostKeyframes)) {
    drawn.keyframes.emplace_back(keyframes[i].T_map_keyframe.translation().head<2>());
    path.push_back({keyframes[i].stamp, keyframes[i].T_map_keyframe});
  }
  std::vector<const LoopCandidate*> links;
  for (const LoopCandidate& loop : loops) {
    if (loop.verdict == CandidateVerdict::accepted || loop.verdict == CandidateVerdict::revoked) {
      links.push_back(&loop);
    }
  }
  const auto place = [&](NodeId id) -> Eigen::Vector2d {
    return graph.nodes()[graph.index_of(id)].T_map_node.translation().head<2>();
  };
  for (std::size_t i = 0; i < links.size(); i += stride_of(links.size(), kMostLinks)) {
    drawn.loops.push_back({.from = place(links[i]->from),
                           .to = place(links[i]->to),
                           .revoked = links[i]->verdict == CandidateVerdict::revoked});
  }
  return map_picture({}, path, "Keyframes and loops from above", drawn);
}

}  // namespace adit
