// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <ostream>

#include <fmt/core.h>

#include "adit/benchmarks/slam/slam_report.hpp"

namespace adit::bench {
namespace {

std::string right(const std::string& text, std::size_t width) {
  return std::string(width > text.size() ? width - text.size() : 0, ' ') + text;
}

std::string left(const std::string& text, std::size_t width) {
  return text + std::string(width > text.size() ? width - text.size() : 0, ' ');
}

constexpr std::size_t kDescription = 22;

/// An error, the best of its row with a star.
std::string cell(const SlamRow& row, std::size_t system) {
  const SlamResult& result = row.results[system];
  switch (result.verdict) {
    case SlamVerdict::missing:
      return "-";
    case SlamVerdict::failed:
      return "x";
    case SlamVerdict::good:
      break;
  }
  return (best_of(row) == system && row.results.size() > 1 ? "*" : "") +
         fmt::format("{:.3f}", result.errors->ate);
}

}  // namespace

std::size_t system_width(const SlamReport& report) {
  std::size_t width = 9;
  for (const SlamSystem& system : report.systems) {
    width = std::max(width, system.name.size() + 2);
  }
  return width;
}

void print_setting(const SlamReport& report, std::size_t sequences, std::ostream& out) {
  const Setting& s = report.setting;
  out << "device   " << s.device << ", " << s.driver << " " << s.driver_version
      << (s.software ? ", software" : "") << "\n"
      << "host     " << s.host << ", " << s.threads << " threads\n"
      << "adit     " << s.version << " (" << s.commit << ")\n";
  for (const SlamSystem& system : report.systems) {
    out << "system   " << system.name << ": " << system.origin << "\n";
  }
  out << "failed   error above "
      << fmt::format(
             "{:.3g} % of the path and {:.3g} m, more than {:.3g} % of the sweeps lost, or less "
             "than {:.3g} % of the path",
             100.0 * report.limits.error_share, report.limits.error_least,
             100.0 * report.limits.lost_share, 100.0 * report.limits.covered_share)
      << "\n\n"
      << sequences << " sequences\n\n";
}

void print_head(const SlamReport& report, std::ostream& out) {
  out << left("sequence", kSequenceWidth) << left("sensor", kDescription) << right("path m", 8)
      << "  " << left("system", system_width(report)) << right("ATE m", 9) << right("max m", 9)
      << right("deg", 8) << right("drift %", 9) << right("placed", 11) << right("ms", 8) << "\n";
}

void print_result(const SlamReport& report, const SlamRow& row, std::size_t system,
                  std::ostream& out) {
  const SlamResult& result = row.results[system];
  const bool first = system == 0;
  out << left(first ? row.sequence : "", kSequenceWidth)
      << left(first ? row.description : "", kDescription)
      << right(first && result.errors ? fmt::format("{:.1f}", result.errors->path) : "", 8) << "  "
      << left(report.systems[system].name, system_width(report));
  if (result.verdict == SlamVerdict::missing) {
    out << right("-", 9) << "  no trajectory\n";
    return;
  }
  if (result.errors) {
    const SlamErrors& errors = *result.errors;
    out << right(fmt::format("{:.3f}", errors.ate), 9)
        << right(fmt::format("{:.3f}", errors.ate_largest), 9)
        << right(fmt::format("{:.2f}", errors.ate_rotation), 8)
        << right(errors.drift ? fmt::format("{:.2f}", 100.0 * *errors.drift) : "-", 9);
  } else {
    out << right("-", 9) << right("-", 9) << right("-", 8) << right("-", 9);
  }
  if (result.effort) {
    out << right(fmt::format("{}/{}", result.effort->placed, result.effort->sweeps), 11)
        << right(fmt::format("{:.1f}", result.effort->ms_a_sweep), 8);
  } else {
    out << right("", 19);
  }
  out << (result.verdict == SlamVerdict::failed ? "  FAILED: " + result.why : "") << "\n";
}

void print_table(const SlamReport& report, std::ostream& out) {
  std::vector<std::size_t> widths;
  out << "\nATE RMSE (m), SE(3)-aligned; * least of its row, x failed, - no trajectory\n"
      << left("sequence", kSequenceWidth);
  for (const SlamSystem& system : report.systems) {
    widths.push_back(std::max<std::size_t>(10, system.name.size() + 3));
    out << right(system.name, widths.back());
  }
  out << "\n";
  for (const SlamRow& row : report.rows) {
    out << left(row.sequence, kSequenceWidth);
    for (std::size_t i = 0; i < row.results.size(); ++i) {
      out << right(cell(row, i), widths[i]);
    }
    out << "\n";
  }
  const SlamTotals totals = totals_of(report);
  if (!totals.mean_ate.empty()) {
    out << left(fmt::format("mean of {} without x", totals.mastered_by_all), kSequenceWidth);
    for (std::size_t i = 0; i < totals.mean_ate.size(); ++i) {
      out << right(fmt::format("{:.3f}", totals.mean_ate[i]), widths[i]);
    }
    out << "\n";
  }
  out << left("failed", kSequenceWidth);
  for (std::size_t i = 0; i < totals.failures.size(); ++i) {
    out << right(std::to_string(totals.failures[i]), widths[i]);
  }
  out << "\n";
}

}  // namespace adit::bench
