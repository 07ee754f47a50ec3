// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_merge/tie_file.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "adit/tools/map_database/map_records.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kVerdicts = {CandidateVerdict::waiting, CandidateVerdict::accepted,
                                  CandidateVerdict::rejected, CandidateVerdict::revoked};
constexpr std::array kSources = {LoopSource::position, LoopSource::appearance, LoopSource::hand};

Json edge_json(const PoseEdge& edge) {
  Json json;
  json["from"] = edge.from;
  json["to"] = edge.to;
  json["pose"] = pose_numbers(edge.T_from_to);
  json["information"] = std::vector<double>(edge.information.data(), edge.information.data() + 36);
  return json;
}

Json candidate_json(const LoopCandidate& candidate) {
  Json json;
  json["from"] = candidate.from;
  json["to"] = candidate.to;
  json["pose"] = pose_numbers(candidate.T_from_to);
  json["source"] = to_string(candidate.source);
  json["verdict"] = to_string(candidate.verdict);
  json["reason"] = candidate.reason;
  json["figures"] = {candidate.score,      candidate.overlap, candidate.chi2,    candidate.rms,
                     candidate.correction, candidate.turn,    candidate.through, candidate.figure};
  return json;
}

Eigen::Isometry3d pose_of(const Json& json) {
  return pose_from(json.get<PoseNumbers>());
}

PoseEdge edge_of(const Json& json) {
  PoseEdge edge{.from = json.at("from").get<NodeId>(),
                .to = json.at("to").get<NodeId>(),
                .T_from_to = pose_of(json.at("pose")),
                .kind = EdgeKind::loop};
  const auto numbers = json.at("information").get<std::array<double, 36>>();
  edge.information = Eigen::Map<const Matrix6d>(numbers.data());
  return edge;
}

template <class Words>
auto by_name(const Words& words, const std::string& name) {
  const auto found =
      std::ranges::find_if(words, [&](auto word) { return to_string(word) == name; });
  if (found == words.end()) {
    throw Json::other_error::create(501, "'" + name + "' is unknown", nullptr);
  }
  return *found;
}

/// JSON has no infinity: it writes null.
double figure_of(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

LoopCandidate candidate_of(const Json& json) {
  std::array<double, 8> figures{};
  for (std::size_t i = 0; i < figures.size(); ++i) {
    figures[i] = figure_of(json.at("figures").at(i));
  }
  return {.from = json.at("from").get<NodeId>(),
          .to = json.at("to").get<NodeId>(),
          .T_from_to = pose_of(json.at("pose")),
          .source = by_name(kSources, json.at("source").get<std::string>()),
          .score = figures[0],
          .overlap = figures[1],
          .chi2 = figures[2],
          .verdict = by_name(kVerdicts, json.at("verdict").get<std::string>()),
          .reason = json.at("reason").get<std::string>(),
          .rms = figures[3],
          .correction = figures[4],
          .turn = figures[5],
          .through = figures[6],
          .figure = figures[7]};
}

std::optional<double> number_or_none(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

}  // namespace

std::string to_json(const MapTie& tie) {
  const MergeSearch& search = tie.search;
  Json json;
  json["tied"] = search.is_tied;
  json["candidates"] = search.candidates;
  json["verified"] = search.verified;
  json["accepted"] = search.accepted;
  json["keyframes"] = search.keyframes;
  json["log_odds"] = search.log_odds ? Json(*search.log_odds) : Json();
  json["built_alike_log_odds"] =
      search.built_alike_log_odds ? Json(*search.built_alike_log_odds) : Json();
  json["not_searched"] = tie.not_searched;
  json["edges"] = Json::array();
  for (const PoseEdge& edge : tie.edges) {
    json["edges"].push_back(edge_json(edge));
  }
  json["pairs"] = Json::array();
  for (const LoopCandidate& candidate : tie.candidates) {
    json["pairs"].push_back(candidate_json(candidate));
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

MapTie read_tie(const std::filesystem::path& file, std::size_t one, std::size_t other) {
  try {
    const Json json = Json::parse(read_text_file(file));
    MapTie tie;
    tie.one = one;
    tie.other = other;
    tie.not_searched = json.at("not_searched").get<std::string>();
    tie.search.in.push_back(0);
    tie.search.map = 1;
    tie.search.candidates = json.at("candidates").get<std::size_t>();
    tie.search.verified = json.at("verified").get<std::size_t>();
    tie.search.accepted = json.at("accepted").get<std::size_t>();
    tie.search.keyframes = json.at("keyframes").get<std::size_t>();
    tie.search.log_odds = number_or_none(json.at("log_odds"));
    tie.search.built_alike_log_odds = number_or_none(json.at("built_alike_log_odds"));
    tie.search.is_tied = json.at("tied").get<bool>();
    for (const Json& edge : json.at("edges")) {
      tie.edges.push_back(edge_of(edge));
    }
    for (const Json& candidate : json.at("pairs")) {
      tie.candidates.push_back(candidate_of(candidate));
    }
    return tie;
  } catch (const Json::exception& error) {
    throw InputError(file, {}, std::string("it is no tie of two maps: ") + error.what(),
                     "Remove it: the next run makes it again");
  }
}

}  // namespace adit
