// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_edits/loop_addition.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/loops/loop_reason.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// The earlier keyframe first.
LoopByHand in_order(LoopByHand loop) {
  if (loop.from > loop.to) {
    std::swap(loop.from, loop.to);
    loop.guess = loop.guess ? std::optional(loop.guess->inverse()) : std::nullopt;
  }
  return loop;
}

/// Throws UsageError where no loop between the two can be added.
void check(const MapDatabase& map, const LoopByHand& loop) {
  for (const NodeId id : {loop.from, loop.to}) {
    if (!map.keyframe(id)) {
      throw UsageError("the map has no keyframe " + std::to_string(id) +
                       ". `adit export MAP --trajectory csv` lists those it has.");
    }
  }
  if (loop.from == loop.to) {
    throw UsageError("a loop leads from one keyframe to another one.");
  }
  for (const LoopCandidate& known : map.candidates()) {
    if (known.from == loop.from && known.to == loop.to &&
        (known.verdict == CandidateVerdict::accepted ||
         known.verdict == CandidateVerdict::revoked)) {
      throw UsageError("loop " + std::to_string(known.id) + " is between the two, and " +
                       std::string(to_string(known.verdict)) + ".");
    }
  }
}

[[noreturn]] void refuse(const std::filesystem::path& map, const std::string& reason) {
  throw InputError(map, {}, "there is no loop as it was said: " + reason,
                   "Nothing was changed. docs/theory/loops.md says what the reasons mean; "
                   "`adit loops MAP --add A B --guess X Y Z YAW` tells how the second keyframe "
                   "lies, seen from the first");
}

LoopVerification verified(const MapDatabase& map, const LoopByHand& loop,
                          const VerifyLoop& verify) {
  try {
    return verify(map, loop);
  } catch (const NoGuess& none) {
    throw UsageError(std::string(none.what()) +
                     "; `adit loops MAP --add A B --guess X Y Z YAW` is needed.");
  } catch (const SubmapDamaged& damage) {
    throw InputError(map.file(), {}, "a submap is damaged: " + std::string(damage.what()),
                     "`adit check` says which");
  }
}

int64_t next_id(const std::vector<LoopCandidate>& candidates) {
  int64_t id = 1;
  for (const LoopCandidate& candidate : candidates) {
    id = std::max(id, candidate.id + 1);
  }
  return id;
}

}  // namespace

LoopChange add_loop(const std::filesystem::path& file, LoopByHand wanted,
                    const VerifyLoop& verify) {
  // A writer would make the file where there is none.
  static_cast<void>(MapDatabase(file, MapAccess::read));
  MapDatabase map(file, MapAccess::write);
  const LoopByHand loop = in_order(std::move(wanted));
  check(map, loop);
  const LoopVerification verdict = verified(map, loop, verify);
  if (verdict.reason != LoopReason::none) {
    refuse(file, std::string(to_string(verdict.reason)) + fmt::format(" {:.3g}", verdict.figure));
  }
  PoseGraph graph = settled(map.graph(), file);
  const PoseEdge edge{.from = loop.from,
                      .to = loop.to,
                      .T_from_to = verdict.T_from_to,
                      .information = symmetric_inverse(verdict.covariance),
                      .kind = EdgeKind::loop};
  graph.add_edge(edge);
  const OptimizedGraph optimized = optimized_map(graph, file);
  const std::optional<EdgeResult>& residual = optimized.report.edges.back();
  if (!residual || residual->chi2 > kLoopReview) {
    refuse(file, "it contradicts the rest of the graph, chi squared " +
                     fmt::format("{:.3g}", residual ? residual->chi2 : 0.0));
  }
  std::vector<LoopCandidate> candidates = map.candidates();
  const int64_t id = next_id(candidates);
  candidates.push_back({.id = id,
                        .from = loop.from,
                        .to = loop.to,
                        .T_from_to = verdict.T_from_to,
                        .source = LoopSource::hand,
                        .overlap = verdict.overlap,
                        .verdict = CandidateVerdict::accepted,
                        .reason = std::string(to_string(LoopReason::added_by_hand)),
                        .rms = verdict.rms,
                        .correction = verdict.correction,
                        .turn = verdict.turn,
                        .through = verdict.through});
  const LoopChange changed{.id = id,
                           .what = "added",
                           .cost_before = optimized.report.cost_before,
                           .cost_after = optimized.report.cost_after,
                           .moved = farthest_moved(graph, optimized.poses)};
  const std::vector<LoopCandidate> records =
      with_residuals(candidates, graph, optimized.report, file);
  graph.set_poses(optimized.poses);
  map.revise({.edges = {edge},
              .candidates = records,
              .poses = graph.nodes(),
              .georeference = placed(map.georeference(), optimized.T_world_map)});
  return changed;
}

}  // namespace adit
