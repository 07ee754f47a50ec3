// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit bench slam --loops` asks of a system on a sequence: the loops that it closes, as
// `adit evaluate OUT TRUTH --loops` scores them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "adit/benchmarks/slam/slam_sequences.hpp"
#include "adit/tools/evaluation/run_loops.hpp"
#include "adit/tools/report/loop_reasons.hpp"

namespace adit::bench {

/// How the search went.
struct SlamLoopSearch {
  std::size_t revisits = 0;  ///< in the truth
  std::size_t found = 0;     ///< of these
  std::size_t offered = 0;   ///< candidates
  LoopReasonCounts removed{};
  std::optional<double> a_second{};  ///< candidates, of the search's host time; none: no search
  double keyframe_ms = 0.0;          ///< mean host time of all that mapping does for a keyframe
  double longest_wait_s = 0.0;       ///< of a sweep for the map
};

/// A system's loops on a sequence.
struct SlamLoops {
  std::size_t accepted = 0;
  std::size_t false_ones = 0;  ///< of these
  LoopEffect effect{};
  std::optional<SlamLoopSearch> search{};  ///< none: another system's
};

/// Of a run of ours in `folder`, of which `summary` is the summary.json; nothing where the run has
/// no map. The sequence has a table of loops. Throws InputError.
std::optional<SlamLoops> loops_of_run(const SlamSequence& sequence,
                                      const std::filesystem::path& folder,
                                      const nlohmann::json& summary);

/// Of another system: SYSTEM/NAME.loops.csv has a closure a line, its two times (time_a_s,
/// time_b_s) and T_a_b between the sensor's poses at these (x y z qx qy qz qw);
/// SYSTEM/NAME.odometry.tum is what they do not correct. Nothing where there is no table. Throws
/// InputError.
std::optional<SlamLoops> loops_of_system(const SlamSequence& sequence,
                                         const std::filesystem::path& system);

}  // namespace adit::bench
