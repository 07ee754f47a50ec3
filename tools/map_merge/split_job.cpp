// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_merge/split_job.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/map_database/unfinished_map.hpp"
#include "adit/tools/map_database/writer_lock.hpp"
#include "adit/tools/map_merge/merge_inputs.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

std::set<SessionId> chosen(const SplitCommandOptions& options,
                           const std::vector<MapSession>& sessions) {
  std::string known;
  for (const MapSession& session : sessions) {
    known += fmt::format("{}{}", known.empty() ? "" : ", ", session.id);
  }
  std::set<SessionId> asked(options.sessions.begin(), options.sessions.end());
  for (const SessionId id : asked) {
    if (std::ranges::find(sessions, id, &MapSession::id) == sessions.end()) {
      throw UsageError(
          fmt::format("--session {}: {} has the sessions {}.", id, options.map.string(), known));
    }
  }
  if (asked.size() == sessions.size()) {
    throw UsageError(
        fmt::format("--session: these are all sessions of {}; a copy of the file has them.",
                    options.map.string()));
  }
  return asked;
}

/// What belongs to the keyframes of some sessions.
class Share {
 public:
  Share(const MapDatabase& map, const std::set<SessionId>& sessions) {
    for (const MapKeyframe& keyframe : map.keyframes()) {
      if (sessions.contains(keyframe.session)) {
        keyframes.push_back(keyframe);
        nodes_.insert(keyframe.id);
      }
    }
    const PoseGraph graph = map.graph();
    for (const PoseEdge& edge : graph.edges()) {
      if (has(edge.from) && has(edge.to)) {
        rest.edges.push_back(edge);
      }
    }
    rest.candidates = map.candidates();
    std::erase_if(rest.candidates,
                  [&](const LoopCandidate& one) { return !has(one.from) || !has(one.to); });
    rest.fixes = map.fixes();
    std::erase_if(rest.fixes, [&](const MapFix& fix) { return !has(fix.keyframe); });
    std::vector<MapHeading> headings = map.headings();
    std::erase_if(headings, [&](const MapHeading& one) { return !has(one.keyframe); });
    rest.headings = std::move(headings);
    rest.georeference = map.georeference();
    std::vector<ControlPoint> control = map.control_points();
    std::erase_if(control, [&](const ControlPoint& point) { return !has(point.keyframe); });
    rest.control = std::move(control);
  }

  std::vector<MapKeyframe> keyframes{};
  MapRevision rest{};

 private:
  bool has(NodeId node) const { return nodes_.contains(node); }

  std::set<NodeId> nodes_;
};

}  // namespace

SplitOutcome split_job(const SplitCommandOptions& options) {
  require_free_output({options.map}, options.output);
  const std::filesystem::path file = find_map(options.map);
  if (const std::optional<std::string> writer = writer_of(file)) {
    throw LockedError(
        file, file.string() + ": is being written by " + *writer + ". Split it when that is done.");
  }
  const MapDatabase map(file, MapAccess::read);
  const std::set<SessionId> sessions = chosen(options, map.sessions());
  const Share share(map, sessions);
  const UnfinishedMap unfinished(options.output);
  SplitOutcome outcome{.georeferenced = share.rest.georeference.has_value()};
  {
    MapDatabase out(unfinished.part(), MapAccess::write);
    std::map<SessionId, SessionId> numbers;
    for (const SessionId id : sessions) {
      const MapSession session = *map.session(id);
      numbers[id] = out.add_session(session);
      outcome.sessions.push_back({.id = numbers[id], .name = session.name, .from = file});
    }
    for (const MapKeyframe& keyframe : share.keyframes) {
      KeyframeRecord record{.keyframe = keyframe, .submap = map.submap(keyframe.id)};
      record.keyframe.session = numbers.at(keyframe.session);
      out.store(record);
      ++outcome.sessions[static_cast<std::size_t>(record.keyframe.session) - 1].keyframes;
    }
    out.revise(share.rest);
    for (const SessionId id : sessions) {
      if (map.progress(id).complete) {
        out.set_complete(numbers.at(id));
      }
    }
    const PoseGraph graph = out.graph();
    outcome.components = connected_components(graph).components.size();
    for (const PoseEdge& edge : graph.edges()) {
      const bool is_loop = edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active;
      outcome.loops += is_loop ? 1U : 0U;
      outcome.edges += edge.kind == EdgeKind::odometry ? 1U : 0U;
    }
  }
  unfinished.take_its_place();
  return outcome;
}

std::string describe(const SplitCommandOptions& options, const SplitOutcome& outcome) {
  std::string text = "session  keyframes  name\n";
  for (const MergedSession& session : outcome.sessions) {
    text += fmt::format("{:7}  {:9}  {}\n", session.id, session.keyframes, session.name);
  }
  text += fmt::format("edges     {} of the odometry, {} loops\n", outcome.edges, outcome.loops);
  if (outcome.components > 1) {
    text += fmt::format(
        "note      {} parts that nothing ties together now: what tied them belongs to sessions "
        "that "
        "were left out, or the odometry started anew\n",
        outcome.components);
  }
  return text + fmt::format("wrote     {}\n", options.output.string());
}

std::string to_json(const SplitCommandOptions& options, const SplitOutcome& outcome) {
  nlohmann::ordered_json json = {{"schema", "split/1"}, {"output", options.output.string()}};
  json["sessions"] = nlohmann::ordered_json::array();
  for (const MergedSession& session : outcome.sessions) {
    json["sessions"].push_back(
        {{"id", session.id}, {"name", session.name}, {"keyframes", session.keyframes}});
  }
  json["odometry_edges"] = outcome.edges;
  json["loops"] = outcome.loops;
  json["components"] = outcome.components;
  json["georeferenced"] = outcome.georeferenced;
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace adit
