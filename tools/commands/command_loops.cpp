// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_loops.hpp"

#include <algorithm>
#include <cstddef>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/slam/mapping/loop_closer.hpp"
#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_line.hpp"
#include "adit/tools/maps/map_database.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// What a change by hand has done to the map.
struct Changed {
  int64_t id = 0;
  EdgeStatus status = EdgeStatus::active;
  double cost_before = 0.0;
  double cost_after = 0.0;
  double moved = 0.0;  ///< m, that keyframe which moved most
};

std::string name_of(CandidateVerdict verdict) {
  switch (verdict) {
    case CandidateVerdict::waiting:
      return "waiting";
    case CandidateVerdict::accepted:
      return "accepted";
    case CandidateVerdict::rejected:
      return "rejected";
    case CandidateVerdict::revoked:
      return "revoked";
  }
  return "unknown";
}

LoopCandidate& find(std::vector<LoopCandidate>& candidates, int64_t id, CandidateVerdict expected) {
  const auto found = std::ranges::find(candidates, id, &LoopCandidate::id);
  if (found == candidates.end()) {
    throw UsageError("the map has no loop " + std::to_string(id) +
                     ". `adit loops MAP` lists those it has.");
  }
  if (found->verdict != expected) {
    throw UsageError("loop " + std::to_string(id) + " is " + name_of(found->verdict) +
                     "; only what is " + name_of(expected) + " can be " +
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

/// Accepted loops say how well they fit after the optimisation.
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

Changed change(const LoopsCommandOptions& options) {
  const bool revoke = options.revoke.has_value();
  Changed changed{.id = revoke ? *options.revoke : options.restore.value_or(0),
                  .status = revoke ? EdgeStatus::revoked : EdgeStatus::active};
  MapDatabase map(options.map, MapAccess::write);
  std::vector<LoopCandidate> candidates = map.candidates();
  LoopCandidate& candidate =
      find(candidates, changed.id, revoke ? CandidateVerdict::accepted : CandidateVerdict::revoked);
  candidate.verdict = revoke ? CandidateVerdict::revoked : CandidateVerdict::accepted;
  candidate.reason = to_string(revoke ? LoopReason::by_hand : LoopReason::none);
  candidate.figure = 0.0;

  PoseGraph graph = map.graph();
  const std::size_t edge = edge_of(graph, candidate, options.map);
  graph.set_status(edge, changed.status);
  const OptimizedGraph optimized = optimize_with_loops(graph);
  if (optimized.report.termination == Termination::failed) {
    throw InputError(options.map, {},
                     "its graph could not be optimised: " + optimized.report.message,
                     "Nothing was changed");
  }
  changed.cost_before = optimized.report.cost_before;
  changed.cost_after = optimized.report.cost_after;
  for (std::size_t i = 0; i < graph.nodes().size(); ++i) {
    changed.moved = std::max(
        changed.moved,
        (optimized.poses[i].translation() - graph.nodes()[i].T_map_node.translation()).norm());
  }
  const std::vector<LoopCandidate> records =
      with_residuals(candidates, graph, optimized.report, options.map);
  graph.set_poses(optimized.poses);
  map.revise({.candidates = records, .statuses = {{edge, changed.status}}, .poses = graph.nodes()});
  return changed;
}

std::string reason_of(const LoopCandidate& candidate) {
  return candidate.reason == to_string(LoopReason::none) || candidate.reason.empty()
             ? "-"
             : candidate.reason + fmt::format(" {:.3g}", candidate.figure);
}

std::string text_of(const LoopsCommandOptions& options,
                    const std::vector<LoopCandidate>& candidates,
                    const std::optional<Changed>& changed) {
  std::string text;
  if (changed) {
    text +=
        fmt::format("{}   loop {}; cost {:.6g}, now {:.6g}; keyframes moved by up to {:.3f} m\n",
                    changed->status == EdgeStatus::revoked ? "revoked" : "restored", changed->id,
                    changed->cost_before, changed->cost_after, changed->moved);
  }
  if (candidates.empty()) {
    return text + options.map.string() +
           " has no loops: none were looked for (mapping.loops), or no place was seen again\n";
  }
  text += "    id    from      to  verdict   overlap  correction           chi2  reason\n";
  for (const LoopCandidate& one : candidates) {
    text += fmt::format("{:6}  {:6}  {:6}  {:<8}  {:7.2f}  {:6.3f} m {:4.1f} deg  {:7.2f}  {}\n",
                        one.id, one.from, one.to, name_of(one.verdict), one.overlap, one.correction,
                        one.turn * kDegreesPerRadian, one.chi2, reason_of(one));
  }
  const auto accepted =
      std::ranges::count(candidates, CandidateVerdict::accepted, &LoopCandidate::verdict);
  return text + fmt::format("{} candidates, {} accepted\n", candidates.size(), accepted);
}

std::string json_of(const LoopsCommandOptions& options,
                    const std::vector<LoopCandidate>& candidates,
                    const std::optional<Changed>& changed) {
  nlohmann::ordered_json json = {{"map", options.map.string()}};
  if (changed) {
    json["changed"] = {{"id", changed->id},
                       {"status", changed->status == EdgeStatus::revoked ? "revoked" : "active"},
                       {"cost_before", changed->cost_before},
                       {"cost_after", changed->cost_after},
                       {"moved_m", changed->moved}};
  }
  json["loops"] = nlohmann::ordered_json::array();
  for (const LoopCandidate& one : candidates) {
    json["loops"].push_back({{"id", one.id},
                             {"from", one.from},
                             {"to", one.to},
                             {"verdict", name_of(one.verdict)},
                             {"reason", one.reason},
                             {"figure", one.figure},
                             {"overlap", one.overlap},
                             {"rms_m", one.rms},
                             {"correction_m", one.correction},
                             {"correction_rad", one.turn},
                             {"seen_through", one.through},
                             {"found_at", one.score},
                             {"chi2", one.chi2}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

int run(const LoopsCommandOptions& options, std::ostream& out) {
  if (options.revoke && options.restore) {
    throw UsageError("--revoke and --restore exclude each other.");
  }
  std::optional<Changed> changed;
  if (options.revoke || options.restore) {
    // A writer would make the file where there is none.
    static_cast<void>(MapDatabase(options.map, MapAccess::read));
    changed = change(options);
  }
  const std::vector<LoopCandidate> candidates =
      MapDatabase(options.map, MapAccess::read).candidates();
  out << (options.json ? json_of(options, candidates, changed)
                       : text_of(options, candidates, changed));
  return 0;
}

}  // namespace

int loops_command(const LoopsCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit loops", out, err, [&] { return run(options, out); });
}

void add_loops_command(Command app, std::function<void(int)> done) {
  const Command command =
      app.add_command("loops", "List the loops of a map with verdicts and reasons; revoke one");
  const auto options = std::make_shared<LoopsCommandOptions>();
  command.footer(
      "MAP is what `adit run` leaves as OUT/map.adit; loops are looked for with mapping.loops.\n"
      "--revoke takes an accepted loop back and optimises the map without it, --restore undoes "
      "that.\n\n"
      "Examples:\n"
      "  adit loops out/map.adit\n"
      "  adit loops out/map.adit --revoke 17\n"
      "  adit loops out/map.adit --json\n\n"
      "Exit codes: 0 done, 1 no map that can be read or written, 2 usage, or no such loop.");
  command.option("map", options->map, "The map").required().value_name("MAP");
  command.option("--revoke", options->revoke, "Take an accepted loop back").value_name("ID");
  command.option("--restore", options->restore, "Let it in again").value_name("ID");
  command.flag("--json", options->json, "Print JSON instead of text");
  command.action(
      [options, done = std::move(done)] { done(loops_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
