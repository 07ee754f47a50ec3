// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The verdict on a run as a whole: the stretches of its sweeps, which sweeps of the recording the
// trajectory has, and what else was not checked or not used.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/odometry/verdict.hpp"
#include "adit/tools/report/run_statistics.hpp"
#include "adit/tools/report/run_summary.hpp"

namespace adit {

/// Why a run as a whole is not reliable.
struct VerdictReason {
  std::string cause;  ///< a word or two, for programs
  Trust trust = Trust::doubtful;
  std::string text;  ///< for people: what happened, and what they can do
};

/// Which sweeps of the recording are in the trajectory.
struct Coverage {
  std::size_t sweeps = 0;        ///< that were to be mapped
  std::size_t placed = 0;        ///< that have a pose
  std::size_t longest = 0;       ///< sweeps without a pose in a row
  double longest_seconds = 0.0;  ///< s, that they last

  std::size_t missing() const { return sweeps - placed; }
};

/// What a run is worth: as much as the worst of its stretches and reasons.
struct RunAssessment {
  Trust trust = Trust::reliable;
  Coverage coverage;
  std::vector<VerdictReason> reasons{};
  std::vector<DoubtfulStretch> stretches{};
  std::optional<MovedByLoops> moved{};  ///< where that is one of the reasons
};

/// Assesses a run that has ended, however it did.
RunAssessment assess_run(const RunDescription& run, const RunOutcome& outcome,
                         const RunStatistics& statistics);

}  // namespace adit
