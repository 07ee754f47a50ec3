// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The loops of a run's map against the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/mapping/map_store.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// An accepted edge is false beyond either of these.
inline constexpr double kFalseLoopMetres = 0.5;
inline constexpr double kFalseLoopDegrees = 3.0;

/// A pair of moments that see the same, as the simulator writes them.
struct TrueLoop {
  Nanoseconds earlier{0};
  Nanoseconds later{0};
  double distance = 0.0;  ///< m
  double overlap = 0.0;
};

/// Reads a table with the columns time_a_s, time_b_s, distance_m and overlap; empty lines are
/// passed over. Throws InputError.
std::vector<TrueLoop> read_true_loops(const std::filesystem::path& file);

/// Throws InputError where the pairs, which are of that file, cannot be of the recording that the
/// truth is of: their moments lie outside of its time, or its places are not as far apart as they
/// say.
void check_true_loops(const std::filesystem::path& file, const std::vector<TrueLoop>& loops,
                      const Trajectory& truth);

/// A candidate of the map beside the truth.
struct ScoredLoop {
  LoopCandidate candidate;
  double metres = 0.0;  ///< its measured pose from the true one
  double degrees = 0.0;
  bool right = false;  ///< within the limits above
};

/// A stretch of at least 5 m whose places were seen before: pairs with an overlap of at least half,
/// at most 5 m apart.
struct Revisit {
  Nanoseconds begin{0};
  Nanoseconds end{0};
  double length = 0.0;            ///< m
  std::vector<TrueLoop> pairs{};  ///< in order of their later moments
  /// By a right edge: its later keyframe is inside, but for the way to the next keyframe, and the
  /// earlier one at most 5 m from a place that was seen again there.
  bool found = false;
};

struct LoopScore {
  std::vector<ScoredLoop> loops;  ///< candidates both of whose keyframes the truth covers
  std::vector<Revisit> revisits;  ///< within the time of the run and of the truth
  std::size_t pairs = 0;          ///< what there was to make revisits of
  std::size_t not_of_run = 0;     ///< revisits before the run's first sweep or after its last
  std::size_t not_in_truth = 0;   ///< pairs of revisits that the truth does not cover
  std::size_t uncovered = 0;      ///< accepted edges that the truth does not cover: not scored
  std::size_t accepted = 0;       ///< of those that it covers
  std::size_t false_ones = 0;     ///< number among the accepted
  // Among the refused, those whose submaps could be aligned:
  std::size_t right_refused = 0;  ///< measured rightly, and not accepted
  std::size_t wrong_refused = 0;  ///< measured wrongly, and not accepted
};

/// `map` is the file, for messages too. Throws InputError, also where there are accepted edges and
/// the truth covers none of them.
LoopScore score_loops(const std::filesystem::path& map, const Trajectory& truth,
                      const std::vector<TrueLoop>& loops);

std::string describe(const LoopScore& score);
/// What the score does not tell, as sentences; empty: it tells all.
std::vector<std::string> warnings_of(const LoopScore& score);
nlohmann::ordered_json to_json(const LoopScore& score);

}  // namespace adit
