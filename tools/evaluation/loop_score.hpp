// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The loops of a run's map against the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/mapping/map_store.hpp"
#include "adit/tools/evaluation/loop_table.hpp"
#include "adit/tools/report/loop_reasons.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// An accepted edge is false beyond either of these.
inline constexpr double kFalseLoopMetres = 0.5;
inline constexpr double kFalseLoopDegrees = 3.0;

/// m of the truth's path between two moments.
double path_between(const Trajectory& truth, Nanoseconds begin, Nanoseconds end);

/// Throws InputError where the pairs, which are of that file, cannot be of the recording that the
/// truth is of: their moments lie outside of its time, or its places are not as far apart as they
/// say.
void check_true_loops(const std::filesystem::path& file, const std::vector<TrueLoop>& loops,
                      const Trajectory& truth);

/// How far a measured pose is from the true one.
struct LoopError {
  double metres = 0.0;
  double degrees = 0.0;
  bool right = false;  ///< within the limits above
};
/// Of T_from_to as measured; the others are the true poses.
LoopError loop_error(const Eigen::Isometry3d& T_from_to, const Eigen::Isometry3d& T_world_from,
                     const Eigen::Isometry3d& T_world_to);

/// A candidate of the map beside the truth.
struct ScoredLoop {
  LoopCandidate candidate;
  LoopError error;
};

/// From the first keyframe that an accepted right edge ties to the last: what is held from both
/// sides. Before and behind it is what the odometry alone knows.
struct LoopSpan {
  Nanoseconds begin{0};
  Nanoseconds end{0};
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
  std::vector<ScoredLoop> loops;   ///< candidates both of whose keyframes the truth covers
  std::vector<Revisit> revisits;   ///< within the time of the run and of the truth
  std::size_t pairs = 0;           ///< what there was to make revisits of
  std::size_t not_of_run = 0;      ///< revisits before the run's first sweep or after its last
  std::size_t not_in_truth = 0;    ///< pairs of revisits that the truth does not cover
  std::size_t uncovered = 0;       ///< accepted edges that the truth does not cover: not scored
  std::size_t accepted = 0;        ///< of those that it covers
  std::size_t false_ones = 0;      ///< number among the accepted
  std::optional<LoopSpan> span{};  ///< none: there is no right edge
  std::size_t offered = 0;         ///< candidates of the map, covered by the truth or not
  /// Of these by the reason that they were refused for, or taken back.
  LoopReasonCounts removed{};
  // Among the refused, those whose submaps could be aligned:
  std::size_t right_refused = 0;  ///< measured rightly, and not accepted
  std::size_t wrong_refused = 0;  ///< measured wrongly, and not accepted
};

/// `map` is the file, for messages too. Throws InputError, also where there are accepted edges and
/// the truth covers none of them.
LoopScore score_loops(const std::filesystem::path& map, const Trajectory& truth,
                      const std::vector<TrueLoop>& loops);

/// Closures of another system by the same limits.
struct MeasuredLoopScore {
  std::size_t accepted = 0;  ///< that the truth covers
  std::size_t false_ones = 0;
  std::size_t uncovered = 0;
  std::optional<LoopSpan> span{};
};
MeasuredLoopScore score_loops(std::span<const MeasuredLoop> loops, const Trajectory& truth);

std::string describe(const LoopScore& score);
/// What the score does not tell, as sentences; empty: it tells all.
std::vector<std::string> warnings_of(const LoopScore& score);
nlohmann::ordered_json to_json(const LoopScore& score);

}  // namespace adit
