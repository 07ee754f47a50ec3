// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The page: what was measured on, the errors by sequence and system, all figures, the trajectories.
#include <algorithm>
#include <sstream>

#include <fmt/core.h>

#include "adit/benchmarks/slam/slam_loops_report.hpp"
#include "adit/benchmarks/slam/slam_report.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/drawing/markup.hpp"

namespace adit::bench {
namespace {

std::string error_cell(const SlamRow& row, std::size_t system) {
  const SlamResult& result = row.results[system];
  switch (result.verdict) {
    case SlamVerdict::missing:
      return "<td>-</td>";
    case SlamVerdict::failed:
      return "<td class=wrong title=\"" + escape_markup(result.why) + "\">&times;</td>";
    case SlamVerdict::good:
      break;
  }
  const auto good = std::ranges::count(row.results, SlamVerdict::good, &SlamResult::verdict);
  return (good > 1 && best_of(row) == system ? "<td class=best>" : "<td>") +
         fmt::format("{:.3f}", result.errors->ate) + "</td>";
}

std::string error_table(const SlamReport& report) {
  std::ostringstream out;
  out << "<table><tr><th>sequence<th class=left>sensor, motion";
  for (const SlamSystem& system : report.systems) {
    out << "<th>" << escape_markup(system.name);
  }
  out << "</tr>\n";
  for (const SlamRow& row : report.rows) {
    out << "<tr><td>" << escape_markup(row.sequence) << "</td><td class=left>"
        << escape_markup(row.description) << "</td>";
    for (std::size_t i = 0; i < row.results.size(); ++i) {
      out << error_cell(row, i);
    }
    out << "</tr>\n";
  }
  const SlamTotals totals = totals_of(report);
  if (!totals.mean_ate.empty()) {
    out << "<tr><td>mean</td><td class=left>of the " << totals.mastered_by_all
        << " that none failed on</td>";
    for (const double ate : totals.mean_ate) {
      out << "<td>" << fmt::format("{:.3f}", ate) << "</td>";
    }
    out << "</tr>\n";
  }
  out << "<tr><td>failed</td><td></td>";
  for (const std::size_t failures : totals.failures) {
    out << "<td>" << failures << "</td>";
  }
  out << "</tr></table>\n";
  return out.str();
}

std::string figure_cells(const SlamResult& result) {
  std::ostringstream out;
  if (result.errors) {
    const SlamErrors& e = *result.errors;
    out << "<td>" << fmt::format("{:.1f}", e.path) << "</td><td>" << fmt::format("{:.3f}", e.ate)
        << "</td><td>" << fmt::format("{:.3f}", e.ate_largest) << "</td><td>"
        << fmt::format("{:.2f}", e.ate_rotation) << "</td><td>"
        << (e.drift ? fmt::format("{:.2f}", 100.0 * *e.drift) : "-") << "</td>";
  } else {
    out << "<td></td><td></td><td></td><td></td><td></td>";
  }
  if (result.effort) {
    out << "<td>" << result.effort->placed << "/" << result.effort->sweeps << "</td><td>"
        << fmt::format("{:.1f}", result.effort->ms_a_sweep) << "</td>";
  } else {
    out << "<td></td><td></td>";
  }
  out << "<td class=\"left wrong\">" << escape_markup(result.why) << "</td>";
  return out.str();
}

std::string figure_table(const SlamReport& report) {
  std::ostringstream out;
  out << "<table><tr><th>sequence<th class=left>system<th>path m<th>ATE m<th>largest m<th>ATE "
         "deg<th>drift %<th>placed<th>ms a sweep<th class=left>failed because</tr>\n";
  for (const SlamRow& row : report.rows) {
    for (std::size_t i = 0; i < row.results.size(); ++i) {
      if (row.results[i].verdict != SlamVerdict::missing) {
        out << "<tr><td>" << escape_markup(row.sequence) << "</td><td class=left>"
            << escape_markup(report.systems[i].name) << "</td>" << figure_cells(row.results[i])
            << "</tr>\n";
      }
    }
  }
  out << "</table>\n";
  return out.str();
}

std::string drawings(const SlamReport& report) {
  std::string html;
  for (const SlamRow& row : report.rows) {
    for (std::size_t i = 0; i < row.results.size(); ++i) {
      const std::string& drawing = row.results[i].drawing;
      if (!drawing.empty()) {
        html += "<details><summary>" + escape_markup(row.sequence + ", " + report.systems[i].name) +
                "</summary>\n" + drawing + "</details>\n";
      }
    }
  }
  return html;
}

}  // namespace

std::string to_html(const SlamReport& report) {
  const Setting& s = report.setting;
  const SlamLimits& l = report.limits;
  std::ostringstream out;
  out << "<h1>Accuracy of trajectories</h1>\n<dl><dt>device<dd>" << escape_markup(s.device)
      << (s.software ? ", software" : "") << "<dt>driver<dd>"
      << escape_markup(s.driver + " " + s.driver_version) << "<dt>host<dd>" << escape_markup(s.host)
      << ", " << s.threads << " threads<dt>adit<dd>" << escape_markup(s.version) << " ("
      << escape_markup(s.commit) << "), " << escape_markup(s.date);
  for (const SlamSystem& system : report.systems) {
    out << "<dt>" << escape_markup(system.name) << "<dd>" << escape_markup(system.origin);
  }
  out << "</dl>\n<h2>ATE RMSE (m)</h2>\n<p>All poses, SE(3)-aligned. Bold: least of its row, where "
         "several are. "
         "&times;: failed, that is an error above "
      << fmt::format("{:g}", 100.0 * l.error_share) << " % of the path and "
      << fmt::format("{:g}", l.error_least) << " m, more than "
      << fmt::format("{:g}", 100.0 * l.lost_share) << " % of the sweeps not placed, or less than "
      << fmt::format("{:g}", 100.0 * l.covered_share)
      << " % of the path covered.</p>\n<div class=scroll>" << error_table(report) << "</div>\n"
      << loops_to_html(report) << "<h2>All figures</h2>\n<p>Drift: the mean error of "
      << "stretches of 10 m. Time: of the host, with reading and writing.</p>\n<div class=scroll>"
      << figure_table(report) << "</div>\n<h2>Trajectories</h2>\n"
      << drawings(report);
  return html_page("adit bench slam", out.str());
}

}  // namespace adit::bench
