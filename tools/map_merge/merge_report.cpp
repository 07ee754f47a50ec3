// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_merge/merge_report.hpp"

#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

std::string table_of(const MergeOutcome& outcome) {
  std::string text = "session  keyframes  position sigma  from\n";
  for (const MergedSession& session : outcome.sessions) {
    const std::string sigma = session.sigma ? fmt::format("{:.3f} m", *session.sigma) : "-";
    text += fmt::format("{:7}  {:9}  {:>14}  {} ({})\n", session.id, session.keyframes, sigma,
                        session.from.string(), session.name);
  }
  text += "sessions  edges  median residual\n";
  for (const SessionTie& tie : outcome.ties) {
    text +=
        fmt::format("{:>8}  {:5}  {:.3f} m, {:.2f} deg\n", fmt::format("{}-{}", tie.one, tie.other),
                    tie.edges, tie.metres, tie.radians * kDegreesPerRadian);
  }
  return text;
}

}  // namespace

std::string reason_apart(const MapApart& apart, std::size_t accepted) {
  if (accepted > 0) {
    return fmt::format("only {} of its keyframes could be tied", accepted);
  }
  if (apart.candidates == 0) {
    return "no place of it looks like one of another map";
  }
  const std::string compared = fmt::format("of {} pairs of keyframes that look alike, {} fit",
                                           apart.candidates, apart.verified);
  if (apart.built_alike_log_odds && *apart.built_alike_log_odds < 0.0) {
    return compared +
           fmt::format(
               "; the places are rather built alike than the same, {:.3g} to 1: too many details "
               "differ",
               std::exp(-*apart.built_alike_log_odds));
  }
  if (!apart.log_odds) {
    return compared + "; they do not agree on one place for the map";
  }
  return compared +
         (*apart.log_odds < 0.0
              ? fmt::format("; another place is {:.3g} times as likely as the best one",
                            std::exp(-*apart.log_odds))
              : fmt::format("; the odds of the best place are {:.3g} to 1, and must be 100 to 1",
                            std::exp(*apart.log_odds)));
}

std::string describe(const MergeCommandOptions& options, const MergeOutcome& outcome) {
  std::string text = outcome.sessions.empty() ? std::string() : table_of(outcome);
  for (const auto& file : outcome.incomplete) {
    text += fmt::format("note      {}: its run has not ended; what it had stored is merged\n",
                        file.string());
  }
  for (const MapApart& map : outcome.apart) {
    text += fmt::format("apart     {}: {}\n", map.file.string(), map.reason);
  }
  if (outcome.sessions.empty()) {
    return text + "wrote     nothing: no map could be tied to another\n";
  }
  if (outcome.components > 1) {
    text += fmt::format(
        "parts     {}, without an edge between them: their relative poses are guesses\n",
        outcome.components);
  }
  text += outcome.georeferenced ? fmt::format("world     by {} GNSS fixes and {} control points\n",
                                              outcome.fixes_used, outcome.control)
                                : "world     no geographic position\n";
  return text + "wrote     " + options.output.string() + "\n";
}

std::string to_json(const MergeCommandOptions& options, const MergeOutcome& outcome) {
  const auto or_null = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json();
  };
  Json json = {{"schema", "merge/1"},
               {"map", outcome.sessions.empty() ? Json() : Json(options.output.string())}};
  json["sessions"] = Json::array();
  for (const MergedSession& session : outcome.sessions) {
    json["sessions"].push_back({{"id", session.id},
                                {"name", session.name},
                                {"from", session.from.string()},
                                {"keyframes", session.keyframes},
                                {"position_sigma_m", or_null(session.sigma)}});
  }
  json["ties"] = Json::array();
  for (const SessionTie& tie : outcome.ties) {
    json["ties"].push_back({{"sessions", {tie.one, tie.other}},
                            {"edges", tie.edges},
                            {"median_residual_m", tie.metres},
                            {"median_residual_rad", tie.radians}});
  }
  json["apart"] = Json::array();
  for (const MapApart& map : outcome.apart) {
    json["apart"].push_back({{"map", map.file.string()},
                             {"keyframes", map.keyframes},
                             {"candidates", map.candidates},
                             {"verified", map.verified},
                             {"log_odds", or_null(map.log_odds)},
                             {"built_alike_log_odds", or_null(map.built_alike_log_odds)},
                             {"reason", map.reason}});
  }
  json["incomplete"] = Json::array();
  for (const auto& file : outcome.incomplete) {
    json["incomplete"].push_back(file.string());
  }
  json["components"] = outcome.components;
  json["georeferenced"] = outcome.georeferenced;
  json["fixes_used"] = outcome.fixes_used;
  json["control_points"] = outcome.control;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace adit
