// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether the odometry errs as much as it says: statistics of runs beside their truth, and their
// forms.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/benchmarks/consistency/consistency_run.hpp"
#include "adit/benchmarks/setting.hpp"
#include "adit/tools/evaluation/pose_consistency.hpp"

namespace adit::bench {

/// What motions are judged over.
inline constexpr std::array kHorizons = {std::chrono::milliseconds(100),
                                         std::chrono::milliseconds(1000),
                                         std::chrono::milliseconds(10'000)};

/// The errors of some runs.
struct Consistency {
  std::size_t runs = 0;
  std::size_t sweeps = 0;   ///< with the inertial sensor
  std::size_t bridged = 0;  ///< coasting or restarted
  Nees last;                ///< last pose in the map, one a run
  Nees all;                 ///< every pose in the map, of sweeps with the inertial sensor
  std::array<Nees, kHorizons.size()> motions{};  ///< motions over each horizon
  double error = 0.0;                            ///< m, of the last position, rms
  double turn = 0.0;                             ///< rad, of the last attitude, rms
  double path = 0.0;                             ///< m, mean
  double nis = 0.0;                              ///< mean over innovations, a degree of freedom
  std::array<double, 5> correlation{};           ///< whitened innovations 1 to 5 sweeps apart
  std::size_t innovations = 0;
};

Consistency consistency_of(std::span<const std::vector<ConsistencySweep>> runs);

/// Between these lie 95 % of the means of `samples` independent chi squared variables of `degrees`
/// degrees of freedom, a degree (Wilson and Hilferty's approximation).
struct MeanBounds {
  double low = 0.0;
  double high = 0.0;
};
MeanBounds chi_squared_bounds(std::size_t samples, int degrees);

/// Below this lie 95 % of the correlations (their absolute values) of white innovations.
double white_bound(const Consistency& found);

struct ConsistencyRow {
  ConsistencyCase what{};
  Consistency found{};
};

struct ConsistencyReport {
  Setting setting{};
  std::vector<std::string> settings{};  ///< those of adit that are none of its defaults
  std::vector<ConsistencyRow> rows{};
  Consistency all{};  ///< the runs of all cases together
};

nlohmann::ordered_json to_json(const ConsistencyReport& report);

/// For people: a line a case, as they come, then the sum.
void print_consistency_head(const ConsistencyReport& report, std::ostream& out);
void print_consistency_row(const std::string& name, const Consistency& found, std::ostream& out);
void print_consistency_verdict(const Consistency& all, std::ostream& out);

}  // namespace adit::bench
