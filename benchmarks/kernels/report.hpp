// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run of `adit bench` found, and its forms: JSON, a table, a page.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/benchmarks/kernels/limits.hpp"
#include "adit/benchmarks/kernels/timing.hpp"
#include "adit/benchmarks/kernels/work.hpp"
#include "adit/benchmarks/setting.hpp"

namespace adit::bench {

/// A case at one size.
struct Row {
  std::string name{};
  CaseKind kind = CaseKind::kernel;
  int size = 0;
  std::string item{};
  std::string peer{};
  uint64_t items = 0;
  Timing timing{};
  Cost cost{};
  std::string verified_by{};
  std::string problem{};  ///< not timed where there is one
  std::map<std::string, double> figures{};

  double ns_an_item() const { return 1e6 * timing.best().median / static_cast<double>(items); }
};

struct Report {
  Setting setting{};
  DeviceLimits limits{};
  LimitsMoved limits_moved{};  ///< between the beginning and the end
  std::vector<Row> rows{};
};

nlohmann::ordered_json to_json(const Report& report);
/// Throws InputError for a file that is not such a report.
Report read_report(const std::filesystem::path& path);

/// For people: what was measured on, its limits, and a line a row.
void print_setting(const Report& report, std::ostream& out);
void print_head(std::ostream& out);
void print_row(const Row& row, const Report& report, std::ostream& out);

/// After the last row: how far the limits moved, and whether shares of them say anything.
void print_limits(const Report& report, std::ostream& out);

/// A self-contained HTML page with roofline and scaling.
std::string to_html(const Report& report);

/// Both reports, row by row: the ratio of the medians, the same by how fast the machine was each
/// time, and whether the spreads are apart then.
void print_comparison(const Report& before, const Report& after, std::ostream& out);

/// Shares of the limits mean something.
inline bool limits_hold(const Report& report) {
  return report.limits_moved.ratio <= kMostMoved;
}

/// The row's peer at the same size; null where it was not measured.
const Row* peer_of(const Row& row, const Report& report);

}  // namespace adit::bench
