// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/run_sources.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <type_traits>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::string_view, 2> kEstimates = {"motion", "map"};
constexpr double kLeastShown = 0.005;  // of a share: it rounds to 1 %

std::string_view name_of(SourceEstimate estimate) {
  return kEstimates.at(static_cast<std::size_t>(estimate));
}

template <class T>
T value_of(const ordered_json& json, const char* key) {
  const auto found = json.find(key);
  const bool fits =
      found != json.end() &&
      (std::is_same_v<T, std::string> ? found->is_string() : found->is_number_unsigned());
  return fits ? found->get<T>() : T{};
}

SourceWorth source_of(const ordered_json& json) {
  SourceWorth source{.name = value_of<std::string>(json, "name"),
                     .topic = value_of<std::string>(json, "topic"),
                     .estimate = value_of<std::string>(json, "estimate") == kEstimates[1]
                                     ? SourceEstimate::map
                                     : SourceEstimate::motion,
                     .unit = value_of<std::string>(json, "unit"),
                     .used = value_of<std::size_t>(json, "used"),
                     .refused = value_of<std::size_t>(json, "refused"),
                     .left_out = value_of<std::size_t>(json, "left_out"),
                     .remark = value_of<std::string>(json, "remark")};
  if (const auto innovation = json.find("innovation_squared_per_degree");
      innovation != json.end() && innovation->is_number()) {
    source.innovation_squared = innovation->get<double>();
  }
  if (const auto shares = json.find("shares"); shares != json.end() && shares->is_object()) {
    for (const auto& [part, share] : shares->items()) {
      if (share.is_number()) {
        source.shares.emplace_back(part, share.get<double>());
      }
    }
  }
  return source;
}

std::vector<SourceWorth> of_estimate(const std::vector<SourceWorth>& sources,
                                     SourceEstimate estimate) {
  std::vector<SourceWorth> chosen;
  std::ranges::copy_if(sources, std::back_inserter(chosen),
                       [&](const SourceWorth& one) { return one.estimate == estimate; });
  return chosen;
}

/// The parts that the first source with shares has.
std::vector<std::string> parts_of(const std::vector<SourceWorth>& sources) {
  const auto found =
      std::ranges::find_if(sources, [](const SourceWorth& one) { return !one.shares.empty(); });
  std::vector<std::string> parts;
  if (found != sources.end()) {
    for (const auto& [part, share] : found->shares) {
      parts.push_back(part);
    }
  }
  return parts;
}

std::optional<double> share_of(const SourceWorth& source, const std::string& part) {
  const auto found = std::ranges::find(source.shares, part, &std::pair<std::string, double>::first);
  return found == source.shares.end() ? std::nullopt : std::optional(found->second);
}

std::string percent_of(const std::optional<double>& share) {
  return share ? fmt::format("{:.0f} %", 100.0 * *share) : "-";
}

std::string row_of(const SourceWorth& one, const std::vector<std::string>& parts) {
  const std::string name = one.topic.empty() ? one.name : one.name + " " + one.topic;
  const std::string innovation =
      one.innovation_squared ? fmt::format("{:.2f}", *one.innovation_squared) : "-";
  std::string row = fmt::format("{:<22} {:>9} {:>8} {:>8} {:<8} {:>6}", name, one.used, one.refused,
                                one.left_out, one.unit, innovation);
  for (const std::string& part : parts) {
    row += fmt::format(" {:>9}", percent_of(share_of(one, part)));
  }
  return row + (one.remark.empty() ? "" : "  " + one.remark);
}

/// "range 30 %, imu 8 %", the largest first.
std::string shares_text(const std::vector<SourceWorth>& sources, const std::string& part) {
  std::vector<std::pair<double, std::string>> shares;
  for (const SourceWorth& one : sources) {
    if (const auto share = share_of(one, part); share && *share >= kLeastShown) {
      shares.emplace_back(-*share, one.name);
    }
  }
  std::ranges::sort(shares);
  std::string text;
  for (const auto& [share, name] : shares) {
    text += (text.empty() ? "" : ", ") + fmt::format("{} {:.0f} %", name, -100.0 * share);
  }
  return text;
}

bool is_further(const SourceWorth& one) {
  constexpr std::array<std::string_view, 5> kUsual = {"lidar", "imu", "start", "odometry",
                                                      "verticals"};
  return std::ranges::find(kUsual, one.name) == kUsual.end() && one.used > 0;
}

}  // namespace

ordered_json to_json(const std::vector<SourceWorth>& sources) {
  ordered_json list = ordered_json::array();
  for (const SourceWorth& one : sources) {
    ordered_json shares = ordered_json::object();
    for (const auto& [part, share] : one.shares) {
      shares[part] = share;
    }
    list.push_back(
        {{"name", one.name},
         {"topic", one.topic.empty() ? ordered_json() : ordered_json(one.topic)},
         {"estimate", name_of(one.estimate)},
         {"unit", one.unit},
         {"used", one.used},
         {"refused", one.refused},
         {"left_out", one.left_out},
         {"remark", one.remark.empty() ? ordered_json() : ordered_json(one.remark)},
         {"innovation_squared_per_degree",
          one.innovation_squared ? ordered_json(*one.innovation_squared) : ordered_json()},
         {"shares", one.shares.empty() ? ordered_json() : shares}});
  }
  return list;
}

std::vector<SourceWorth> sources_of(const ordered_json& json) {
  std::vector<SourceWorth> sources;
  if (json.is_array()) {
    for (const ordered_json& one : json) {
      if (one.is_object()) {
        sources.push_back(source_of(one));
      }
    }
  }
  return sources;
}

std::string describe(const std::vector<SourceWorth>& sources, std::size_t indent) {
  std::string text;
  for (const auto& [estimate, title] :
       {std::pair(SourceEstimate::motion, "of the motion"), {SourceEstimate::map, "of the map"}}) {
    const std::vector<SourceWorth> chosen = of_estimate(sources, estimate);
    if (chosen.empty()) {
      continue;
    }
    const std::vector<std::string> parts = parts_of(chosen);
    const std::string margin(indent, ' ');
    text +=
        (text.empty() ? "" : margin) + fmt::format("{:<22} {:>9} {:>8} {:>8} {:<8} {:>6}", title,
                                                   "used", "refused", "left out", "", "innov.");
    for (const std::string& part : parts) {
      text += fmt::format(" {:>9}", part);
    }
    text += "\n";
    for (const SourceWorth& one : chosen) {
      text += margin + row_of(one, parts) + "\n";
    }
  }
  return text;
}

std::string describe_shares(const std::vector<SourceWorth>& sources) {
  if (std::ranges::none_of(sources, is_further)) {
    return {};
  }
  std::string text;
  const auto add = [&](SourceEstimate estimate, const char* part, const char* what) {
    const std::vector<SourceWorth> chosen = of_estimate(sources, estimate);
    const std::string shares =
        std::ranges::any_of(chosen, is_further) ? shares_text(chosen, part) : std::string();
    text += shares.empty() ? "" : (text.empty() ? "" : "; ") + (what + (": " + shares));
  };
  add(SourceEstimate::motion, "along", "motion along the path");
  add(SourceEstimate::map, "level", "position in the map");
  return text;
}

}  // namespace adit
