// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Sequences that differ by seed and beginning alone, taken together: what holds beyond one of them.
#pragma once

#include <array>
#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "adit/benchmarks/slam/slam_report.hpp"

namespace adit::bench {

/// A system on all sequences of a family.
struct SlamSpread {
  std::size_t runs = 0;    ///< with a trajectory, or failed without one
  std::size_t failed = 0;  ///< by the report's limits
  double median = 0.0;     ///< ATE, m; infinite where half have none
  double worst = 0.0;      ///< ATE, m; infinite where one has none
  double path = 0.0;       ///< m, mean of the truth's paths
};

struct SlamFamily {
  std::string name{};
  std::vector<SlamSpread> systems{};  ///< one a system
};

/// In the order of the report's rows.
std::vector<SlamFamily> families_of(const SlamReport& report);

/// What runs said of themselves (Trust) against what they were: counts[failed][trust].
struct SlamConfusion {
  std::array<std::array<std::size_t, 3>, 2> counts{};
};
SlamConfusion confusion_of(const SlamReport& report, std::size_t system);

/// For people: median, worst and failures by family and system, then the confusions of ours.
void print_families(const SlamReport& report, std::ostream& out);

nlohmann::ordered_json families_to_json(const SlamReport& report);

}  // namespace adit::bench
