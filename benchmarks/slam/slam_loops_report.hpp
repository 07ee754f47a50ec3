// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of `adit bench slam --loops`: a line a sequence and system, then the median and the
// worst over the seeds of each family.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/benchmarks/slam/slam_report.hpp"

namespace adit::bench {

/// Which of two values is worse.
enum class Worse { neither, less, more };

/// A figure of every table, page and JSON of loops.
struct LoopColumn {
  std::string_view title;
  std::string_view key;  ///< in JSON
  int digits = 0;        ///< behind the point
  Worse worse = Worse::neither;
  std::optional<double> (*value)(const SlamResult& result) = nullptr;
};
std::span<const LoopColumn> loop_columns();

/// A system on the sequences of a family, one value a column.
struct LoopSpread {
  std::string family{};
  std::size_t system = 0;
  std::size_t runs = 0;     ///< with or without loops
  std::size_t counted = 0;  ///< of these with loops
  std::vector<std::optional<double>> median{};
  std::vector<std::optional<double>> worst{};  ///< none where neither end is
};
/// In the order of the report's rows; systems that have no loops are left out.
std::vector<LoopSpread> loop_spreads(const SlamReport& report);

/// For people, as results come.
void print_loop_head(const SlamReport& report, std::ostream& out);
void print_loop_result(const SlamReport& report, const SlamRow& row, std::size_t system,
                       std::ostream& out);
/// Median and worst of families with several runs.
void print_loop_spreads(const SlamReport& report, std::ostream& out);

/// Of a result with loops.
nlohmann::ordered_json loops_to_json(const SlamResult& result);
nlohmann::ordered_json loop_spreads_to_json(const SlamReport& report);
/// The same tables for a page; empty without loops.
std::string loops_to_html(const SlamReport& report);

}  // namespace adit::bench
