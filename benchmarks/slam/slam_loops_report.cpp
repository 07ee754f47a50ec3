// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/slam/slam_loops_report.hpp"

#include <algorithm>
#include <array>
#include <ostream>
#include <sstream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/drawing/markup.hpp"

namespace adit::bench {
namespace {

using Json = nlohmann::ordered_json;

template <class Value>
std::optional<double> of_search(const SlamResult& result, Value SlamLoopSearch::*member) {
  return result.loops && result.loops->search
             ? std::optional(static_cast<double>((*result.loops->search).*member))
             : std::nullopt;
}

std::optional<double> recall_of(const SlamResult& result) {
  if (!result.loops || !result.loops->search || result.loops->search->revisits == 0) {
    return std::nullopt;
  }
  const SlamLoopSearch& search = *result.loops->search;
  return 100.0 * static_cast<double>(search.found) / static_cast<double>(search.revisits);
}

std::optional<double> count_of(const SlamResult& result, std::size_t SlamLoops::*member) {
  return result.loops ? std::optional(static_cast<double>((*result.loops).*member)) : std::nullopt;
}

constexpr std::array kColumns = {
    LoopColumn{"path m", "path_m", 1, Worse::neither,
               [](const SlamResult& result) {
                 return result.errors ? std::optional(result.errors->path) : std::nullopt;
               }},
    LoopColumn{"loops", "accepted", 0, Worse::less,
               [](const SlamResult& result) { return count_of(result, &SlamLoops::accepted); }},
    LoopColumn{"false", "false", 0, Worse::more,
               [](const SlamResult& result) { return count_of(result, &SlamLoops::false_ones); }},
    LoopColumn{
        "revisits", "revisits", 0, Worse::neither,
        [](const SlamResult& result) { return of_search(result, &SlamLoopSearch::revisits); }},
    LoopColumn{"found", "found", 0, Worse::less,
               [](const SlamResult& result) { return of_search(result, &SlamLoopSearch::found); }},
    LoopColumn{"recall %", "recall_percent", 0, Worse::less, recall_of},
    LoopColumn{"odometry m", "ate_odometry_m", 3, Worse::more,
               [](const SlamResult& result) {
                 return result.loops ? result.loops->effect.all.odometry : std::nullopt;
               }},
    LoopColumn{"map m", "ate_map_m", 3, Worse::more,
               [](const SlamResult& result) {
                 return result.errors ? std::optional(result.errors->ate) : std::nullopt;
               }},
    LoopColumn{"ends: path", "span_path_m", 1, Worse::neither,
               [](const SlamResult& result) {
                 return result.loops && result.loops->effect.span_path > 0.0
                            ? std::optional(result.loops->effect.span_path)
                            : std::nullopt;
               }},
    LoopColumn{"odometry", "span_ate_odometry_m", 3, Worse::more,
               [](const SlamResult& result) {
                 return result.loops ? result.loops->effect.in_span.odometry : std::nullopt;
               }},
    LoopColumn{"map", "span_ate_map_m", 3, Worse::more,
               [](const SlamResult& result) {
                 return result.loops ? result.loops->effect.in_span.map : std::nullopt;
               }},
    LoopColumn{
        "offered", "offered", 0, Worse::neither,
        [](const SlamResult& result) { return of_search(result, &SlamLoopSearch::offered); }},
    LoopColumn{"a second", "candidates_per_s", 1, Worse::less,
               [](const SlamResult& result) {
                 return result.loops && result.loops->search ? result.loops->search->a_second
                                                             : std::nullopt;
               }},
    LoopColumn{
        "keyframe ms", "keyframe_ms", 0, Worse::more,
        [](const SlamResult& result) { return of_search(result, &SlamLoopSearch::keyframe_ms); }},
    LoopColumn{"wait s", "longest_wait_s", 2, Worse::more, [](const SlamResult& result) {
                 return of_search(result, &SlamLoopSearch::longest_wait_s);
               }}};

std::string text_of(const LoopColumn& column, const std::optional<double>& value) {
  return value ? fmt::format("{:.{}f}", *value, column.digits) : "-";
}

std::size_t width_of(const LoopColumn& column) {
  return std::max<std::size_t>(column.title.size() + 2, 7);
}

std::string removed_by(const SlamResult& result) {
  return result.loops && result.loops->search ? reasons_text(result.loops->search->removed) : "";
}

std::optional<double> worse_of(const std::vector<double>& sorted, Worse worse) {
  return worse == Worse::neither
             ? std::nullopt
             : std::optional(worse == Worse::less ? sorted.front() : sorted.back());
}

LoopSpread spread_of(const std::vector<const SlamResult*>& results) {
  LoopSpread spread{.runs = results.size()};
  spread.counted = static_cast<std::size_t>(std::ranges::count_if(
      results, [](const SlamResult* result) { return result->loops.has_value(); }));
  for (const LoopColumn& column : kColumns) {
    std::vector<double> values;
    for (const SlamResult* result : results) {
      if (const std::optional<double> value = column.value(*result)) {
        values.push_back(*value);
      }
    }
    std::ranges::sort(values);
    const bool any = !values.empty();
    spread.median.push_back(any ? std::optional(values[values.size() / 2]) : std::nullopt);
    spread.worst.push_back(any ? worse_of(values, column.worse) : std::nullopt);
  }
  return spread;
}

void print_values(const std::vector<std::optional<double>>& values, std::ostream& out) {
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    out << fmt::format("{:>{}}", text_of(kColumns[i], values[i]), width_of(kColumns[i]));
  }
}

std::vector<std::optional<double>> values_of(const SlamResult& result) {
  std::vector<std::optional<double>> values;
  for (const LoopColumn& column : kColumns) {
    values.push_back(column.value(result));
  }
  return values;
}

Json to_json(const std::vector<std::optional<double>>& values) {
  Json json = Json::object();
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    json[std::string(kColumns[i].key)] = values[i] ? Json(*values[i]) : Json();
  }
  return json;
}

std::string cells_of(const std::vector<std::optional<double>>& values) {
  std::string html;
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    html += "<td>" + text_of(kColumns[i], values[i]) + "</td>";
  }
  return html;
}

}  // namespace

std::span<const LoopColumn> loop_columns() {
  return kColumns;
}

std::vector<LoopSpread> loop_spreads(const SlamReport& report) {
  std::vector<LoopSpread> spreads;
  for (const SlamRow& first : report.rows) {
    if (std::ranges::count(spreads, first.family, &LoopSpread::family) > 0) {
      continue;
    }
    for (std::size_t system = 0; system < report.systems.size(); ++system) {
      std::vector<const SlamResult*> results;
      for (const SlamRow& row : report.rows) {
        if (row.family == first.family && row.results[system].verdict != SlamVerdict::missing) {
          results.push_back(&row.results[system]);
        }
      }
      LoopSpread spread = spread_of(results);
      spread.family = first.family;
      spread.system = system;
      if (spread.counted > 0) {
        spreads.push_back(std::move(spread));
      }
    }
  }
  return spreads;
}

void print_loop_head(const SlamReport& report, std::ostream& out) {
  out << fmt::format("{:<{}}{:<{}}", "sequence", kSequenceWidth, "system", system_width(report));
  for (const LoopColumn& column : kColumns) {
    out << fmt::format("{:>{}}", column.title, width_of(column));
  }
  out << "  removed by\n";
}

void print_loop_result(const SlamReport& report, const SlamRow& row, std::size_t system,
                       std::ostream& out) {
  const SlamResult& result = row.results[system];
  out << fmt::format("{:<{}}{:<{}}", system == 0 ? row.sequence : "", kSequenceWidth,
                     report.systems[system].name, system_width(report));
  if (result.verdict == SlamVerdict::missing) {
    out << "no trajectory\n";
    return;
  }
  print_values(values_of(result), out);
  const std::string removed = removed_by(result);
  out << (removed.empty() ? "" : "  " + removed)
      << (result.verdict == SlamVerdict::failed ? "  FAILED: " + result.why : "") << "\n";
}

void print_loop_spreads(const SlamReport& report, std::ostream& out) {
  bool any = false;
  for (const LoopSpread& spread : loop_spreads(report)) {
    if (spread.runs < 2) {
      continue;
    }
    out << (any ? "" : "\nover seeds and beginnings, each column by itself\n");
    any = true;
    const std::string name = report.systems[spread.system].name;
    for (const bool is_worst : {false, true}) {
      out << fmt::format("{:<{}}{:<{}}", is_worst ? "  worst" : spread.family, kSequenceWidth,
                         is_worst ? "" : name, system_width(report));
      print_values(is_worst ? spread.worst : spread.median, out);
      out << (is_worst ? "" : fmt::format("  median of {} of {}", spread.counted, spread.runs))
          << "\n";
    }
  }
}

Json loops_to_json(const SlamResult& result) {
  Json json = to_json(values_of(result));
  json["removed"] = result.loops && result.loops->search
                        ? reasons_to_json(result.loops->search->removed)
                        : Json();
  return json;
}

Json loop_spreads_to_json(const SlamReport& report) {
  Json json = Json::array();
  for (const LoopSpread& spread : loop_spreads(report)) {
    json.push_back({{"name", spread.family},
                    {"system", report.systems[spread.system].name},
                    {"runs", spread.runs},
                    {"with_loops", spread.counted},
                    {"median", to_json(spread.median)},
                    {"worst", to_json(spread.worst)}});
  }
  return json;
}

std::string loops_to_html(const SlamReport& report) {
  const std::vector<LoopSpread> spreads = loop_spreads(report);
  if (spreads.empty()) {
    return "";
  }
  std::ostringstream out;
  out << "<h2>Loops</h2>\n<p>ATE of the odometry and of the map, all of it and between the ends of "
         "right loops. Candidates offered, and what each stage of verification removed.</p>\n"
         "<div class=scroll><table><tr><th>sequence<th class=left>system";
  for (const LoopColumn& column : kColumns) {
    out << "<th>" << column.title;
  }
  out << "<th class=left>removed by</tr>\n";
  for (const SlamRow& row : report.rows) {
    for (std::size_t i = 0; i < row.results.size(); ++i) {
      if (row.results[i].verdict != SlamVerdict::missing) {
        out << "<tr><td>" << escape_markup(row.sequence) << "</td><td class=left>"
            << escape_markup(report.systems[i].name) << "</td>"
            << cells_of(values_of(row.results[i])) << "<td class=left>"
            << removed_by(row.results[i]) << "</td></tr>\n";
      }
    }
  }
  for (const LoopSpread& spread : spreads) {
    const std::string system = escape_markup(report.systems[spread.system].name);
    if (spread.runs > 1) {
      out << "<tr><td>" << escape_markup(spread.family) << "</td><td class=left>" << system
          << ", median</td>" << cells_of(spread.median) << "<td></td></tr>\n<tr><td></td>"
          << "<td class=left>worst</td>" << cells_of(spread.worst) << "<td></td></tr>\n";
    }
  }
  out << "</table></div>\n";
  return out.str();
}

}  // namespace adit::bench
