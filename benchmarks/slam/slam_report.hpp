// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run of `adit bench slam` found, and its forms: JSON, tables, a page.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/benchmarks/setting.hpp"
#include "adit/benchmarks/slam/slam_loops.hpp"

namespace adit::bench {

/// From where on a trajectory counts as failed.
struct SlamLimits {
  double error_share = 0.01;    ///< ATE over the length of the truth's path
  double error_least = 0.1;     ///< m, an ATE up to this is never a failure
  double lost_share = 0.1;      ///< sweeps that were not placed
  double covered_share = 0.95;  ///< share of the truth's path, at least
};

enum class SlamVerdict { good, failed, missing };
std::string_view to_string(SlamVerdict verdict);

/// The error of a trajectory, as `adit evaluate` finds it: SE(3) Umeyama.
struct SlamErrors {
  double ate = 0.0;           ///< m, rmse
  double ate_largest = 0.0;   ///< m
  double ate_rotation = 0.0;  ///< deg, rmse
  std::optional<double>
      drift{};           ///< share: mean error over stretches of 10 m; none: path too short
  double path = 0.0;     ///< m, of the truth
  double covered = 0.0;  ///< m of it
};

/// What mapping reported; unknown of other systems.
struct SlamEffort {
  std::size_t sweeps = 0;
  std::size_t placed = 0;
  double ms_a_sweep = 0.0;  ///< mean, with reading and writing
  double sweeps_a_second = 0.0;
};

/// A system on a sequence.
struct SlamResult {
  SlamVerdict verdict = SlamVerdict::missing;
  std::string why{};                   ///< it failed
  std::optional<SlamErrors> errors{};  ///< none where there is no trajectory to judge
  std::optional<SlamEffort> effort{};
  std::optional<SlamLoops> loops{};  ///< with --loops
  std::string trust{};    ///< what the run said of itself (Trust); empty of other systems
  std::string drawing{};  ///< HTML: against the truth
};

/// Judges by what is known of it. A failure that is known already stays.
SlamResult judged(SlamResult result, const SlamLimits& limits);

struct SlamRow {
  std::string sequence{};
  std::string family{};  ///< the sequence's name without its seed
  std::string description{};
  std::vector<SlamResult> results{};  ///< one a system
};

/// A column of the tables.
struct SlamSystem {
  std::string name{};
  std::string origin{};  ///< its settings, or the folder its trajectories come from
};

struct SlamReport {
  Setting setting{};
  SlamLimits limits{};
  std::vector<SlamSystem> systems{};
  std::vector<SlamRow> rows{};
};

nlohmann::ordered_json to_json(const SlamReport& report);

/// Characters of the columns with names.
inline constexpr std::size_t kSequenceWidth = 22;
std::size_t system_width(const SlamReport& report);

/// For people: what is measured on, then a block of lines a sequence, as they come.
void print_setting(const SlamReport& report, std::size_t sequences, std::ostream& out);
void print_head(const SlamReport& report, std::ostream& out);
void print_result(const SlamReport& report, const SlamRow& row, std::size_t system,
                  std::ostream& out);

/// The table at the end: the ATE by sequence and system, the best marked, and why what failed did.
void print_table(const SlamReport& report, std::ostream& out);

/// A self-contained page: the table, all figures, every trajectory against the truth.
std::string to_html(const SlamReport& report);

/// The system of a row with the least error of those that did not fail; none where all did.
std::optional<std::size_t> best_of(const SlamRow& row);

/// The rows that every system mastered, how many each failed on, and the mean error over the
/// former.
struct SlamTotals {
  std::size_t mastered_by_all = 0;
  std::vector<std::size_t> failures{};  ///< one a system
  std::vector<double> mean_ate{};  ///< m, one a system; empty where nothing was mastered by all
};
SlamTotals totals_of(const SlamReport& report);

}  // namespace adit::bench
