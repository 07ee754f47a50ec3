// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_merge/merge_job.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Eigenvalues>

#include "adit/slam/core/median.hpp"
#include "adit/slam/graph/relative_covariance.hpp"
#include "adit/tools/map_merge/merge_report.hpp"

namespace adit {
namespace {

/// The sessions that each keyframe of the merged map belongs to, and the sessions themselves, as
/// the new map numbers them.
struct Numbered {
  std::vector<MergedSession> sessions{};
  std::vector<SessionId> of_keyframes{};
};

Numbered numbered_sessions(const std::vector<MergeInput>& inputs, const MergedMap& merged) {
  Numbered numbered;
  for (const MergedPart& part : merged.parts) {
    const MergeInput& input = inputs[part.map];
    std::map<SessionId, std::size_t> places;
    for (const MapSession& session : input.sessions) {
      places[session.id] = numbered.sessions.size();
      numbered.sessions.push_back({.id = static_cast<SessionId>(numbered.sessions.size()) + 1,
                                   .name = session.name,
                                   .from = input.file});
    }
    for (const MapKeyframe& keyframe : input.keyframes) {
      MergedSession& session = numbered.sessions[places.at(keyframe.session)];
      ++session.keyframes;
      numbered.of_keyframes.push_back(session.id);
    }
  }
  return numbered;
}

void write_merged(const std::filesystem::path& file, const std::vector<MergeInput>& inputs,
                  const MergedMap& merged, const MergedWorld& world, const Numbered& numbered) {
  MapDatabase out(file, MapAccess::write);
  const std::vector<PoseNode>& nodes = world.graph.nodes();
  std::vector<SessionId> complete;
  for (const MergedPart& part : merged.parts) {
    const MergeInput& input = inputs[part.map];
    for (const MapSession& session : input.sessions) {
      const SessionId id = out.add_session(session);
      if (!std::ranges::count(input.incomplete, session.id)) {
        complete.push_back(id);
      }
    }
    for (const MapKeyframe& keyframe : input.keyframes) {
      const auto at = static_cast<std::size_t>(part.merged(keyframe.id));
      KeyframeRecord record{.keyframe = keyframe, .submap = input.map->submap(keyframe.id)};
      record.keyframe.id = nodes[at].id;
      record.keyframe.session = numbered.of_keyframes[at];
      record.keyframe.T_map_keyframe = nodes[at].T_map_node;
      record.keyframe.fixed = nodes[at].fixed;
      out.store(record);
    }
  }
  out.revise({.edges = world.graph.edges(),
              .candidates = merged.candidates,
              .fixes = world.fixes,
              .headings = world.headings,
              .georeference = world.georeference,
              .control = world.control});
  for (const SessionId session : complete) {
    out.set_complete(session);
  }
}

std::vector<SessionTie> ties_of(const PoseGraph& graph, const std::vector<SessionId>& session_of) {
  struct Left {
    std::vector<double> metres;
    std::vector<double> radians;
  };
  std::map<std::pair<SessionId, SessionId>, Left> left;
  for (const PoseEdge& edge : graph.edges()) {
    const std::size_t from = graph.index_of(edge.from);
    const std::size_t to = graph.index_of(edge.to);
    if (edge.status != EdgeStatus::active || session_of[from] == session_of[to]) {
      continue;
    }
    const Eigen::Isometry3d off = edge.T_from_to.inverse() *
                                  graph.nodes()[from].T_map_node.inverse() *
                                  graph.nodes()[to].T_map_node;
    Left& pair = left[std::minmax(session_of[from], session_of[to])];
    pair.metres.push_back(off.translation().norm());
    pair.radians.push_back(rotation_angle(off.linear()));
  }
  std::vector<SessionTie> ties;
  for (const auto& [pair, one] : left) {
    ties.push_back({.one = pair.first,
                    .other = pair.second,
                    .edges = one.metres.size(),
                    .metres = median(one.metres),
                    .radians = median(one.radians)});
  }
  return ties;
}

/// Of a keyframe's position relative to that keyframe of another session that knows it best.
std::optional<double> sigma_of(const RelativeCovariances& covariances, const PoseGraph& graph,
                               std::size_t node, const std::vector<SessionId>& session_of) {
  const auto places = LeastUncertainPaths(covariances, graph.nodes()[node].id).places();
  std::optional<double> least;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] && session_of[i] != session_of[node]) {
      const Eigen::Matrix3d position = places[i]->covariance.topLeftCorner<3, 3>();
      const double variance =
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(position).eigenvalues().maxCoeff();
      least = std::min(least.value_or(variance), variance);
    }
  }
  return least ? std::optional(std::sqrt(std::max(0.0, *least))) : std::nullopt;
}

void add_sigmas(std::vector<MergedSession>& sessions, const PoseGraph& graph,
                const std::vector<SessionId>& session_of) {
  constexpr std::size_t kAsked = 25;  // keyframes a session, evenly spaced
  const RelativeCovariances covariances(graph);
  for (MergedSession& session : sessions) {
    std::vector<std::size_t> nodes;
    for (std::size_t i = 0; i < session_of.size(); ++i) {
      if (session_of[i] == session.id) {
        nodes.push_back(i);
      }
    }
    std::vector<double> sigmas;
    for (std::size_t i = 0; i < std::min(kAsked, nodes.size()); ++i) {
      const std::size_t node = nodes[i * nodes.size() / std::min(kAsked, nodes.size())];
      if (const auto sigma = sigma_of(covariances, graph, node, session_of)) {
        sigmas.push_back(*sigma);
      }
    }
    session.sigma = sigmas.empty() ? std::nullopt : std::optional(median(sigmas));
  }
}

MergeOutcome outcome_of(const std::vector<MergeInput>& inputs, const MergedMap& merged,
                        const MergedWorld& world, const Numbered& numbered) {
  MergeOutcome outcome{.sessions = numbered.sessions,
                       .ties = ties_of(world.graph, numbered.of_keyframes),
                       .apart = maps_apart(inputs, merged)};
  add_sigmas(outcome.sessions, world.graph, numbered.of_keyframes);
  for (const MergedPart& part : merged.parts) {
    if (!inputs[part.map].incomplete.empty()) {
      outcome.incomplete.push_back(inputs[part.map].file);
    }
  }
  outcome.components = connected_components(world.graph).components.size();
  outcome.georeferenced = world.georeference.has_value();
  outcome.fixes_used =
      static_cast<std::size_t>(std::ranges::count(world.fixes, FixVerdict::used, &MapFix::verdict));
  outcome.control = static_cast<std::size_t>(
      std::ranges::count(world.control, ControlRole::control, &ControlPoint::role));
  return outcome;
}

}  // namespace

std::vector<MapApart> maps_apart(const std::vector<MergeInput>& inputs, const MergedMap& merged) {
  std::vector<MapApart> apart;
  for (std::size_t map = 0; map < inputs.size(); ++map) {
    const bool is_merged =
        merged.parts.size() > 1 && std::ranges::count(merged.parts, map, &MergedPart::map) > 0;
    if (is_merged) {
      continue;
    }
    MapApart one{.file = inputs[map].file, .keyframes = inputs[map].keyframes.size()};
    std::size_t accepted = 0;
    for (const MergeSearch& search : merged.searches) {
      if (search.map == map || std::ranges::count(search.in, map) > 0) {
        one.candidates += search.is_tied ? 0 : search.candidates;
        one.verified += search.is_tied ? 0 : search.verified;
        accepted = std::max(accepted, search.is_tied ? 0 : search.keyframes);
        if (!search.is_tied && search.log_odds) {
          one.log_odds = std::max(one.log_odds.value_or(*search.log_odds), *search.log_odds);
        }
        if (!search.is_tied && search.built_alike_log_odds) {
          const double odds = *search.built_alike_log_odds;
          one.built_alike_log_odds = std::min(one.built_alike_log_odds.value_or(odds), odds);
        }
      }
    }
    one.reason = reason_apart(one, accepted);
    apart.push_back(std::move(one));
  }
  return apart;
}

MergeOutcome write_merged_map(const TiedMaps& tied, const UnfinishedMap& unfinished) {
  if (!tied.world) {
    return {.apart = maps_apart(tied.inputs, tied.merged)};
  }
  const Numbered numbered = numbered_sessions(tied.inputs, tied.merged);
  MergeOutcome outcome = outcome_of(tied.inputs, tied.merged, *tied.world, numbered);
  write_merged(unfinished.part(), tied.inputs, tied.merged, *tied.world, numbered);
  unfinished.take_its_place();
  return outcome;
}

MergeOutcome merge_job(const MergeCommandOptions& options,
                       const std::function<bool(const MergeStep&)>& on_step) {
  require_free_output(options.maps, options.output);
  std::vector<MergeInput> opened = open_merge_inputs(options.maps);
  const UnfinishedMap unfinished(options.output);
  return write_merged_map(tie_maps(std::move(opened), options.device, options.settings, on_step),
                          unfinished);
}

}  // namespace adit
