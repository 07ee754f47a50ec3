// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_edits/loop_change.hpp"

#include <algorithm>
#include <optional>

#include <fmt/core.h>

#include "adit/slam/loops/loop_reason.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

LoopCandidate& find(std::vector<LoopCandidate>& candidates, int64_t id, CandidateVerdict expected) {
  const auto found = std::ranges::find(candidates, id, &LoopCandidate::id);
  if (found == candidates.end()) {
    throw UsageError("the map has no loop " + std::to_string(id) +
                     ". `adit loops MAP` lists those it has.");
  }
  if (found->verdict != expected) {
    throw UsageError("loop " + std::to_string(id) + " is " +
                     std::string(to_string(found->verdict)) + "; only what is " +
                     std::string(to_string(expected)) + " can be " +
                     (expected == CandidateVerdict::accepted ? "revoked." : "restored."));
  }
  return *found;
}

std::size_t edge_of(const PoseGraph& graph, const LoopCandidate& candidate,
                    const std::filesystem::path& map) {
  const auto found = std::ranges::find_if(graph.edges(), [&](const PoseEdge& edge) {
    return edge.kind == EdgeKind::loop && edge.from == candidate.from && edge.to == candidate.to;
  });
  if (found == graph.edges().end()) {
    throw InputError(map, {}, "loop " + std::to_string(candidate.id) + " has no edge",
                     "The map is damaged");
  }
  return static_cast<std::size_t>(found - graph.edges().begin());
}

LoopCandidate revoked(LoopCandidate loop) {
  loop.verdict = CandidateVerdict::revoked;
  loop.reason = to_string(LoopReason::by_hand);
  return loop;
}

LoopCandidate restored(LoopCandidate loop) {
  if (loop.reason != to_string(LoopReason::by_hand)) {
    loop.figure = 0.0;  // of a reason that is gone; no votes
  }
  loop.verdict = CandidateVerdict::accepted;
  loop.reason =
      to_string(loop.source == LoopSource::hand ? LoopReason::added_by_hand : LoopReason::none);
  return loop;
}

}  // namespace

std::vector<LoopCandidate> with_residuals(std::vector<LoopCandidate> candidates,
                                          const PoseGraph& graph, const OptimizationReport& report,
                                          const std::filesystem::path& map) {
  for (LoopCandidate& candidate : candidates) {
    if (candidate.verdict == CandidateVerdict::accepted) {
      const std::optional<EdgeResult>& result = report.edges[edge_of(graph, candidate, map)];
      candidate.chi2 = result ? result->chi2 : candidate.chi2;
    }
  }
  return candidates;
}

double farthest_moved(const PoseGraph& graph, const std::vector<Eigen::Isometry3d>& poses) {
  double moved = 0.0;
  for (std::size_t i = 0; i < graph.nodes().size(); ++i) {
    moved = std::max(moved,
                     (poses[i].translation() - graph.nodes()[i].T_map_node.translation()).norm());
  }
  return moved;
}

OptimizedGraph optimized_map(const PoseGraph& graph, const std::filesystem::path& map) {
  OptimizedGraph optimized = optimize_with_loops(graph);
  if (optimized.report.termination == Termination::failed) {
    throw InputError(map, {}, "its graph could not be optimised: " + optimized.report.message,
                     "Nothing was changed");
  }
  return optimized;
}

PoseGraph settled(PoseGraph graph, const std::filesystem::path& map) {
  const OptimizedGraph optimized = optimized_map(graph, map);
  graph.set_poses(optimized.poses);
  graph.set_T_world_map(optimized.T_world_map);
  return graph;
}

LoopChange change_loop(const std::filesystem::path& file, int64_t id, LoopAction action) {
  const bool revoke = action == LoopAction::revoke;
  const EdgeStatus status = revoke ? EdgeStatus::revoked : EdgeStatus::active;
  LoopChange changed{.id = id, .what = revoke ? "revoked" : "restored"};
  // A writer would make the file where there is none.
  static_cast<void>(MapDatabase(file, MapAccess::read));
  MapDatabase map(file, MapAccess::write);
  std::vector<LoopCandidate> candidates = map.candidates();
  LoopCandidate& candidate =
      find(candidates, id, revoke ? CandidateVerdict::accepted : CandidateVerdict::revoked);
  candidate = revoke ? revoked(candidate) : restored(candidate);

  PoseGraph graph = settled(map.graph(), file);
  const std::size_t edge = edge_of(graph, candidate, file);
  graph.set_status(edge, status);
  const OptimizedGraph optimized = optimized_map(graph, file);
  const std::optional<EdgeResult>& residual = optimized.report.edges[edge];
  if (!revoke && (!residual || residual->chi2 > kLoopReview)) {
    throw InputError(file, {},
                     fmt::format("loop {} contradicts the rest of the graph, chi squared {:.3g}",
                                 id, residual ? residual->chi2 : 0.0),
                     "Nothing was changed");
  }
  changed.cost_before = optimized.report.cost_before;
  changed.cost_after = optimized.report.cost_after;
  changed.moved = farthest_moved(graph, optimized.poses);
  const std::vector<LoopCandidate> records =
      with_residuals(candidates, graph, optimized.report, file);
  graph.set_poses(optimized.poses);
  map.revise({.candidates = records,
              .statuses = {{edge, status}},
              .poses = graph.nodes(),
              .georeference = placed(map.georeference(), optimized.T_world_map)});
  return changed;
}

}  // namespace adit
