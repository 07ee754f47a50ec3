// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/slam/slam_report.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/slam/slam_families.hpp"
#include "adit/benchmarks/slam/slam_loops_report.hpp"

namespace adit::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSlamSchema = "bench-slam/1";

Json to_json(const SlamErrors& errors) {
  return {{"ate_rmse_m", errors.ate},
          {"ate_max_m", errors.ate_largest},
          {"ate_rotation_rmse_deg", errors.ate_rotation},
          {"drift_percent", errors.drift ? Json(100.0 * *errors.drift) : Json()},
          {"path_m", errors.path},
          {"covered_path_m", errors.covered}};
}

Json to_json(const SlamEffort& effort) {
  return {{"sweeps", effort.sweeps},
          {"placed", effort.placed},
          {"ms_a_sweep", effort.ms_a_sweep},
          {"sweeps_per_s", effort.sweeps_a_second}};
}

Json to_json(const SlamResult& result, const SlamSystem& system) {
  return {{"system", system.name},
          {"verdict", to_string(result.verdict)},
          {"why", result.why},
          {"trust", result.trust.empty() ? Json() : Json(result.trust)},
          {"errors", result.errors ? to_json(*result.errors) : Json()},
          {"effort", result.effort ? to_json(*result.effort) : Json()},
          {"loops", result.loops ? loops_to_json(result) : Json()}};
}

Json to_json(const Setting& s) {
  return {{"version", s.version}, {"commit", s.commit},     {"date", s.date},
          {"device", s.device},   {"driver", s.driver},     {"driver_version", s.driver_version},
          {"vulkan", s.vulkan},   {"software", s.software}, {"host", s.host},
          {"threads", s.threads}};
}

std::string complaint(const SlamResult& result, const SlamLimits& limits) {
  if (result.effort) {
    const auto sweeps = static_cast<double>(result.effort->sweeps);
    const std::size_t lost = result.effort->sweeps - result.effort->placed;
    if (static_cast<double>(lost) > limits.lost_share * sweeps) {
      return fmt::format("{} of {} sweeps could not be placed", lost, result.effort->sweeps);
    }
  }
  const SlamErrors& errors = *result.errors;
  if (errors.covered < limits.covered_share * errors.path) {
    return fmt::format("it covers {:.1f} of {:.1f} m", errors.covered, errors.path);
  }
  if (errors.ate > std::max(limits.error_least, limits.error_share * errors.path)) {
    return fmt::format("an error of {:.2f} m, {:.1f} % of the path", errors.ate,
                       100.0 * errors.ate / errors.path);
  }
  return {};
}

}  // namespace

std::string_view to_string(SlamVerdict verdict) {
  switch (verdict) {
    case SlamVerdict::good:
      return "good";
    case SlamVerdict::failed:
      return "failed";
    case SlamVerdict::missing:
      return "missing";
  }
  return "unknown";
}

SlamResult judged(SlamResult result, const SlamLimits& limits) {
  if (result.verdict == SlamVerdict::failed || !result.errors) {
    return result;
  }
  result.why = complaint(result, limits);
  result.verdict = result.why.empty() ? SlamVerdict::good : SlamVerdict::failed;
  return result;
}

std::optional<std::size_t> best_of(const SlamRow& row) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < row.results.size(); ++i) {
    const SlamResult& result = row.results[i];
    if (result.verdict == SlamVerdict::good &&
        (!best || result.errors->ate < row.results[*best].errors->ate)) {
      best = i;
    }
  }
  return best;
}

SlamTotals totals_of(const SlamReport& report) {
  SlamTotals totals{.failures = std::vector<std::size_t>(report.systems.size()),
                    .mean_ate = std::vector<double>(report.systems.size())};
  for (const SlamRow& row : report.rows) {
    const bool mastered = std::ranges::all_of(
        row.results, [](const auto& result) { return result.verdict == SlamVerdict::good; });
    totals.mastered_by_all += mastered ? 1U : 0U;
    for (std::size_t i = 0; i < row.results.size(); ++i) {
      totals.failures[i] += row.results[i].verdict == SlamVerdict::failed ? 1U : 0U;
      totals.mean_ate[i] += mastered ? row.results[i].errors->ate : 0.0;
    }
  }
  if (totals.mastered_by_all == 0) {
    totals.mean_ate.clear();
  }
  for (double& ate : totals.mean_ate) {
    ate /= static_cast<double>(totals.mastered_by_all);
  }
  return totals;
}

Json to_json(const SlamReport& report) {
  Json json = {{"schema", kSlamSchema},
               {"setting", to_json(report.setting)},
               {"limits",
                {{"error_share_of_path", report.limits.error_share},
                 {"error_least_m", report.limits.error_least},
                 {"lost_share_of_sweeps", report.limits.lost_share},
                 {"covered_share_of_path", report.limits.covered_share}}},
               {"systems", Json::array()},
               {"sequences", Json::array()}};
  for (const SlamSystem& system : report.systems) {
    json["systems"].push_back({{"name", system.name}, {"origin", system.origin}});
  }
  for (const SlamRow& row : report.rows) {
    Json results = Json::array();
    for (std::size_t i = 0; i < row.results.size(); ++i) {
      results.push_back(to_json(row.results[i], report.systems[i]));
    }
    json["sequences"].push_back({{"name", row.sequence},
                                 {"family", row.family},
                                 {"description", row.description},
                                 {"results", results}});
  }
  json["families"] = families_to_json(report);
  json["loop_families"] = loop_spreads_to_json(report);
  return json;
}

}  // namespace adit::bench
