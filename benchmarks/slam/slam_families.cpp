// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/slam/slam_families.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace adit::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kTrusts = {"reliable", "doubtful", "lost"};
constexpr int kName = 24;

SlamSpread spread_of(const std::vector<const SlamRow*>& rows, std::size_t system) {
  SlamSpread spread;
  std::vector<double> errors;
  double paths = 0.0;
  for (const SlamRow* row : rows) {
    const SlamResult& result = row->results[system];
    if (result.verdict == SlamVerdict::missing) {
      continue;
    }
    ++spread.runs;
    spread.failed += result.verdict == SlamVerdict::failed ? 1U : 0U;
    errors.push_back(result.errors ? result.errors->ate : std::numeric_limits<double>::infinity());
    paths += result.errors ? result.errors->path : 0.0;
    spread.path = result.errors ? result.errors->path : spread.path;
  }
  if (errors.empty()) {
    return spread;
  }
  std::ranges::sort(errors);
  const auto measured = std::ranges::count_if(errors, [](double e) { return std::isfinite(e); });
  spread.path = measured > 0 ? paths / static_cast<double>(measured) : 0.0;
  spread.median = errors[errors.size() / 2];
  spread.worst = errors.back();
  return spread;
}

std::string error_text(double error) {
  return std::isfinite(error) ? fmt::format("{:>8.3f}", error) : "       x";
}

Json json_of(double error) {
  return std::isfinite(error) ? Json(error) : Json();
}

}  // namespace

std::vector<SlamFamily> families_of(const SlamReport& report) {
  std::vector<std::string> names;
  for (const SlamRow& row : report.rows) {
    if (std::ranges::find(names, row.family) == names.end()) {
      names.push_back(row.family);
    }
  }
  std::vector<SlamFamily> families;
  for (const std::string& name : names) {
    std::vector<const SlamRow*> rows;
    for (const SlamRow& row : report.rows) {
      if (row.family == name) {
        rows.push_back(&row);
      }
    }
    SlamFamily& family = families.emplace_back(SlamFamily{.name = name});
    for (std::size_t system = 0; system < report.systems.size(); ++system) {
      family.systems.push_back(spread_of(rows, system));
    }
  }
  return families;
}

SlamConfusion confusion_of(const SlamReport& report, std::size_t system) {
  SlamConfusion confusion;
  for (const SlamRow& row : report.rows) {
    const SlamResult& result = row.results[system];
    const auto trust = std::ranges::find(kTrusts, result.trust);
    if (trust != kTrusts.end()) {
      const std::size_t failed = result.verdict == SlamVerdict::failed ? 1 : 0;
      ++confusion.counts[failed][static_cast<std::size_t>(trust - kTrusts.begin())];
    }
  }
  return confusion;
}

void print_families(const SlamReport& report, std::ostream& out) {
  out << "\nby family, over its seeds and beginnings: ATE (m) median and worst, failed of runs\n";
  for (const SlamFamily& family : families_of(report)) {
    for (std::size_t i = 0; i < family.systems.size(); ++i) {
      const SlamSpread& spread = family.systems[i];
      if (spread.runs > 0) {
        out << fmt::format("{:<{}}{:<12}{}{}  {} of {}  ({:.1f} m)\n",
                           i == 0 ? family.name.c_str() : "", kName, report.systems[i].name,
                           error_text(spread.median), error_text(spread.worst), spread.failed,
                           spread.runs, spread.path);
      }
    }
  }
  for (std::size_t i = 0; i < report.systems.size(); ++i) {
    const auto& [good, failed] = confusion_of(report, i).counts;
    if (good[0] + good[1] + good[2] + failed[0] + failed[1] + failed[2] > 0) {
      out << fmt::format(
          "\nwhat {} said of its runs    reliable  doubtful      lost\n"
          "  within the limits{:20}{:10}{:10}\n  failed{:31}{:10}{:10}\n",
          report.systems[i].name, good[0], good[1], good[2], failed[0], failed[1], failed[2]);
    }
  }
}

Json families_to_json(const SlamReport& report) {
  Json json = Json::array();
  for (const SlamFamily& family : families_of(report)) {
    Json systems = Json::array();
    for (std::size_t i = 0; i < family.systems.size(); ++i) {
      const SlamSpread& spread = family.systems[i];
      systems.push_back({{"system", report.systems[i].name},
                         {"runs", spread.runs},
                         {"failed", spread.failed},
                         {"ate_median_m", json_of(spread.median)},
                         {"ate_worst_m", json_of(spread.worst)},
                         {"path_m", spread.path}});
    }
    json.push_back({{"name", family.name}, {"systems", systems}});
  }
  return json;
}

}  // namespace adit::bench
