// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the files of a run say of it, without a truth: was it held, was it fused, do errors and
// their bounds agree.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/tools/results/run_sources.hpp"
#include "adit/tools/results/sweep_table.hpp"

namespace adit {

/// A time in which some direction was held by few matches or by none.
struct WeakStretch {
  double begin = 0.0;  ///< s after the first sweep
  double end = 0.0;    ///< s
  std::size_t sweeps = 0;
  std::size_t unheld = 0;                          ///< number of them held by no match that agrees
  bool rotation = false;                           ///< else translation
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< mean of the weakest, unit, map
};

/// Innovations against what their covariances promise.
struct InnovationReview {
  std::size_t count = 0;
  double per_degree = 0.0;      ///< mean of the squares per degree of freedom; 1 is right
  double beyond_95 = 0.0;       ///< share beyond chi squared's 95 %; 0.05 is right
  std::size_t beyond_gate = 0;  ///< outliers
};

/// How the run ended, by its summary.json.
struct RunEnding {
  std::string status;                 ///< RunEnd, or "running"; empty: it does not say
  std::string reason;                 ///< for people
  std::optional<std::size_t> wanted;  ///< sweeps that were to be mapped
};

/// What the run said of itself, by its summary.json.
struct RunVerdict {
  std::string state;                   ///< Trust: "reliable", "doubtful" or "lost"
  std::vector<std::string> reasons;    ///< for people: of the run as a whole, and what to do
  std::vector<std::string> stretches;  ///< likewise of its sweeps: where, why
};

struct RunReview {
  std::vector<SweepRecord> sweeps;
  std::vector<double> times;  ///< s after the first sweep
  std::vector<WeakStretch> weak;
  InnovationReview innovations;
  std::optional<double> min_overlap;  ///< that the run's settings asked for
  std::optional<RunVerdict> verdict;  ///< none: an older run, or one that was killed
  std::optional<RunEnding> ending;    ///< none: these are not the sweeps of a run
  std::vector<SourceWorth> sources;   ///< empty: summary.json has none
};

/// Reviews sweeps in the order of time; without min_overlap.
RunReview review_sweeps(std::vector<SweepRecord> sweeps);

/// Reviews the folder of a run, also of one that was killed. Throws InputError where there is no
/// sweeps.csv.
RunReview review_run(const std::filesystem::path& folder);

/// The bound that 95 % stay below, chi squared of 1 to 6 degrees of freedom.
double chi_squared_95(int degrees);

/// Angle between gravity in the map and -z, rad; NaN where it is not known.
double tilt_of(const SweepRecord& sweep);

/// "completed, 300 of 300 sweeps", or that the run was killed, stopped or failed.
std::string describe(const RunEnding& ending, std::size_t sweeps);

/// For people, and for programs.
std::string describe(const RunReview& review);
nlohmann::ordered_json to_json(const RunReview& review);

}  // namespace adit
