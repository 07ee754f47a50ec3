// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_loops.hpp"

#include <algorithm>
#include <cstddef>
#include <iostream>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/loops/loop_move.hpp"
#include "adit/slam/loops/loop_reason.hpp"
#include "adit/slam/mapping/loop_by_hand.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/evaluation/loops_page.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/map_edits/loop_addition.hpp"
#include "adit/tools/map_edits/loop_change.hpp"
#include "adit/tools/run/loop_verifier.hpp"
#include "adit/tools/run/map_use.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// X Y Z YAW, m and degrees.
Eigen::Isometry3d guess_of(std::span<const double> numbers) {
  const StartPlace place = start_place("--guess", numbers);
  Eigen::Isometry3d guess(Eigen::AngleAxisd(place.heading, Eigen::Vector3d::UnitZ()));
  guess.translation() = place.position;
  return guess;
}

InputError damaged(const std::filesystem::path& map, const SubmapDamaged& damage) {
  return {map, {}, "a submap is damaged: " + std::string(damage.what()), "`adit check` says which"};
}

LoopChange add(const LoopsCommandOptions& options) {
  LoopByHand loop{.from = options.add[0], .to = options.add[1]};
  if (!options.guess.empty()) {
    loop.guess = guess_of(options.guess);
  }
  return add_loop(options.map, loop, loop_verifier(options.device));
}

bool was_accepted(const LoopCandidate& candidate) {
  return candidate.verdict == CandidateVerdict::accepted ||
         candidate.verdict == CandidateVerdict::revoked;
}

/// By hand nothing decides but somebody; a loop that is in has votes, which have their own column.
std::string reason_of(const LoopCandidate& candidate) {
  const std::string& reason = candidate.reason;
  if (reason == to_string(LoopReason::none) || reason.empty()) {
    return "-";
  }
  const bool has_figure =
      reason != to_string(LoopReason::by_hand) && reason != to_string(LoopReason::added_by_hand);
  return has_figure ? reason + fmt::format(" {:.3g}", candidate.figure) : reason;
}

/// "appearance 0.72": how alike the two places are.
std::string finding_of(const LoopCandidate& candidate) {
  const std::string source(to_string(candidate.source));
  return candidate.source == LoopSource::appearance
             ? fmt::format("{} {:.2f}", source, candidate.score)
             : source;
}

/// By the ids of candidates with an edge: how far each is from the graph before it came in.
using MovesById = std::map<int64_t, LoopMove>;

MovesById moves_of(const std::vector<LoopCandidate>& candidates, const PoseGraph& graph) {
  std::map<std::pair<NodeId, NodeId>, LoopMove> by_ends;
  const auto moves = moves_from_graph_before(graph);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (moves[i]) {
      by_ends.emplace(std::pair(graph.edges()[i].from, graph.edges()[i].to), *moves[i]);
    }
  }
  MovesById result;
  for (const LoopCandidate& one : candidates) {
    const auto move = by_ends.find({one.from, one.to});
    if (was_accepted(one) && move != by_ends.end()) {
      result.emplace(one.id, move->second);
    }
  }
  return result;
}

const LoopMove* find(const MovesById& moves, const LoopCandidate& candidate) {
  const auto found = moves.find(candidate.id);
  return found == moves.end() ? nullptr : &found->second;
}

/// Where the pose comes from that the correction is of: that of a loop that came in is of the graph
/// before it, whatever its alignment started from.
std::string correction_from(const LoopCandidate& candidate, const LoopMove* move) {
  return move != nullptr || candidate.source == LoopSource::position
             ? "graph"
             : std::string(to_string(candidate.source));
}

/// Later keyframes that agree; known of what the vote has let in.
std::optional<int> votes_of(const LoopCandidate& candidate) {
  const bool voted = candidate.verdict == CandidateVerdict::accepted &&
                     candidate.source != LoopSource::hand && candidate.figure > 0.0;
  return voted ? std::optional(static_cast<int>(std::lround(candidate.figure))) : std::nullopt;
}

std::string text_of(const LoopsCommandOptions& options,
                    const std::vector<LoopCandidate>& candidates, const PoseGraph& graph,
                    const std::optional<LoopChange>& changed) {
  const MovesById moves = moves_of(candidates, graph);
  std::string text;
  if (changed) {
    text += fmt::format(
        "{}   loop {}; cost {:.6g}, now {:.6g}; keyframes moved by up to {:.3f} m\n", changed->what,
        changed->id, changed->cost_before, changed->cost_after, changed->moved);
  }
  if (candidates.empty()) {
    return text + options.map.string() +
           " has no loops: none were looked for (mapping.loops), or no place was seen again\n";
  }
  text +=
      "    id    from      to  found by         verdict   overlap  from graph before   its chi2  "
      "residual chi2  votes  reason\n";
  for (const LoopCandidate& one : candidates) {
    const bool has_edge = was_accepted(one);
    const LoopMove* const move = find(moves, one);
    // That of what was refused is of where its alignment started.
    const bool known = move != nullptr || correction_from(one, move) == "graph";
    const std::string correction =
        known
            ? fmt::format("{:6.3f} m {:5.1f} deg", move != nullptr ? move->metres : one.correction,
                          (move != nullptr ? move->radians : one.turn) * kDegreesPerRadian)
            : "-";
    const std::string chi2 = move != nullptr      ? fmt::format("{:.2f}", move->chi2)
                             : has_edge || !known ? "-"
                                                  : fmt::format("{:.2f}", one.chi2);
    const std::string residual = has_edge ? fmt::format("{:.2f}", one.chi2) : "-";
    const std::optional<int> votes = votes_of(one);
    text += fmt::format(
        "{:6}  {:6}  {:6}  {:<15}  {:<8}  {:7.2f}  {:>18}  {:>8}  {:>13}  {:>5}  {}\n", one.id,
        one.from, one.to, finding_of(one), to_string(one.verdict), one.overlap, correction, chi2,
        residual, votes ? std::to_string(*votes) : "-", reason_of(one));
  }
  const auto accepted =
      std::ranges::count(candidates, CandidateVerdict::accepted, &LoopCandidate::verdict);
  return text + fmt::format("{} candidates, {} accepted\n", candidates.size(), accepted);
}

/// x y z (m) and quaternion x y z w.
nlohmann::ordered_json json_of_pose(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d& p = pose.translation();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

/// Standard deviations of the measured pose, [rho, phi]; of what has an edge.
std::optional<Vector6d> sigmas_of(const LoopCandidate& candidate, const PoseGraph& graph) {
  if (!was_accepted(candidate)) {
    return std::nullopt;
  }
  const auto edge = std::ranges::find_if(graph.edges(), [&](const PoseEdge& one) {
    return one.kind == EdgeKind::loop && one.from == candidate.from && one.to == candidate.to;
  });
  if (edge == graph.edges().end()) {
    return std::nullopt;
  }
  return symmetric_inverse(edge->information).diagonal().cwiseMax(0.0).cwiseSqrt();
}

nlohmann::ordered_json json_of(const LoopCandidate& one, const PoseGraph& graph,
                               const LoopMove* move) {
  using Json = nlohmann::ordered_json;
  const std::optional<Vector6d> sigmas = sigmas_of(one, graph);
  const auto three = [&](int first) {
    return sigmas ? Json{(*sigmas)[first], (*sigmas)[first + 1], (*sigmas)[first + 2]} : Json();
  };
  const bool has_edge = was_accepted(one);
  const std::optional<int> votes = votes_of(one);
  return {{"id", one.id},
          {"from", one.from},
          {"to", one.to},
          {"verdict", std::string(to_string(one.verdict))},
          {"reason", one.reason},
          {"figure", one.figure},
          {"votes", votes ? Json(*votes) : Json()},
          {"T_from_to", json_of_pose(one.T_from_to)},
          {"T_from_to_sigma_m", three(0)},
          {"T_from_to_sigma_rad", three(3)},
          {"overlap", one.overlap},
          {"rms_m", one.rms},
          {"correction_from", correction_from(one, move)},
          {"correction_m", move != nullptr ? move->metres : one.correction},
          {"correction_rad", move != nullptr ? move->radians : one.turn},
          {"correction_chi2", move != nullptr ? Json(move->chi2)
                              : has_edge      ? Json()
                                              : Json(one.chi2)},
          {"path_m", move != nullptr ? Json(move->path) : Json()},
          {"seen_through", one.through},
          {"found_by", std::string(to_string(one.source))},
          {"found_at", one.score},
          {"residual_chi2", has_edge ? Json(one.chi2) : Json()},
          {"chi2", one.chi2}};
}

std::string json_of(const LoopsCommandOptions& options, const MapDatabase& map,
                    const std::vector<LoopCandidate>& candidates,
                    const std::optional<LoopChange>& changed) {
  nlohmann::ordered_json json = {{"schema", "loops/1"}, {"map", options.map.string()}};
  if (changed) {
    json["changed"] = {{"id", changed->id},
                       {"status", changed->what == "revoked" ? "revoked" : "active"},
                       {"what", changed->what},
                       {"cost_before", changed->cost_before},
                       {"cost_after", changed->cost_after},
                       {"moved_m", changed->moved}};
  }
  const PoseGraph graph = map.graph();
  const MovesById moves = moves_of(candidates, graph);
  json["loops"] = nlohmann::ordered_json::array();
  for (const LoopCandidate& one : candidates) {
    json["loops"].push_back(json_of(one, graph, find(moves, one)));
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// Throws UsageError where the map has none of these.
void check_shown(const std::filesystem::path& file, const std::vector<int64_t>& shown) {
  const std::vector<LoopCandidate> candidates = MapDatabase(file, MapAccess::read).candidates();
  for (const int64_t id : shown) {
    if (std::ranges::count(candidates, id, &LoopCandidate::id) == 0) {
      throw UsageError("--show: the map has no loop " + std::to_string(id) +
                       ". `adit loops MAP` lists those it has.");
    }
  }
}

std::string page_of(const MapDatabase& map, const std::vector<int64_t>& shown) {
  try {
    return loops_page(map, shown);
  } catch (const SubmapDamaged& damage) {
    throw damaged(map.file(), damage);
  }
}

int run(const LoopsCommandOptions& options, std::ostream& out) {
  const bool adds = !options.add.empty();
  if (static_cast<int>(options.revoke.has_value()) + static_cast<int>(options.restore.has_value()) +
          static_cast<int>(adds) >
      1) {
    throw UsageError("--revoke, --restore and --add exclude each other.");
  }
  if (!options.guess.empty() && !adds) {
    throw UsageError("--guess needs --add.");
  }
  if (!options.show.empty() && !options.html) {
    throw UsageError("--show needs --html.");
  }
  // What cannot be shown or written is told before anything is changed.
  check_shown(options.map, options.show);
  std::optional<Draft> page;
  if (options.html) {
    page.emplace(*options.html);
    write_text_file(page->path(), "");
  }
  std::optional<LoopChange> changed;
  if (options.revoke || options.restore || adds) {
    changed = adds ? add(options)
              : options.revoke
                  ? change_loop(options.map, *options.revoke, LoopAction::revoke)
                  : change_loop(options.map, options.restore.value_or(0), LoopAction::restore);
  }
  const MapDatabase map(options.map, MapAccess::read);
  const std::vector<LoopCandidate> candidates = map.candidates();
  if (page) {
    write_text_file(page->path(), page_of(map, options.show));
    page->take_its_place();
  }
  out << (options.json ? json_of(options, map, candidates, changed)
                       : text_of(options, candidates, map.graph(), changed));
  if (options.html && !options.json) {
    out << "look at  " << options.html->string() << "\n";
  }
  return 0;
}

}  // namespace

int loops_command(const LoopsCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit loops", out, err, [&] {
    LoopsCommandOptions found = options;
    found.map = find_map(options.map);
    return run(found, out);
  });
}

void add_loops_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command(
      "loops", "List and show the loops of a map with verdicts and reasons; revoke, add one");
  const auto options = std::make_shared<LoopsCommandOptions>();
  command.footer(
      "OUT is the folder of a run, MAP the map in it, OUT/map.adit; loops are looked for with "
      "mapping.loops.\n"
      "--revoke takes an accepted loop back and optimises the map without it, --restore undoes "
      "that.\n--add verifies a loop between two keyframes on the device as a run does, and lets it "
      "in if "
      "it holds.\n\n"
      "Examples:\n"
      "  adit loops out\n"
      "  adit loops out --html loops.html\n"
      "  adit loops out --html loops.html --show 17 --show 18\n"
      "  adit loops out --revoke 17\n"
      "  adit loops out --add 3 118 --guess 1.5 0 0 170\n"
      "  adit loops out/map.adit --json\n\n"
      "Exit codes: 0 done, 1 no map that can be read or written, 2 usage, or no such loop.");
  command.option("map", options->map, "The map, or the folder of its run")
      .required()
      .value_name("MAP|OUT");
  command.option("--revoke", options->revoke, "Take an accepted loop back").value_name("ID");
  command.option("--restore", options->restore, "Let it in again").value_name("ID");
  command.option("--add", options->add, "Let a loop between these keyframes in, if there is one")
      .values(2, 2)
      .value_name("A B");
  command
      .option("--guess", options->guess,
              "How B lies, seen from A: metres and degrees; else as the map has it")
      .values(4, 4)
      .value_name("X Y Z YAW");
  command
      .option("--html", options->html,
              "Write a page that shows each loop: its submaps upon each other, before and after")
      .value_name("FILE.html")
      .written({".html", ".htm"});
  command.option("--show", options->show, "Draw this loop on the page; may be given again")
      .one_value_each()
      .value_name("ID");
  add_device_options(command, options->device);
  command.flag("--json", options->json, "Print JSON instead of text");
  command.action(
      [options, done = std::move(done)] { done(loops_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
