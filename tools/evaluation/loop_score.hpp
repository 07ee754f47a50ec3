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

/// Reads a table with the columns time_a_s, time_b_s, distance_m and overlap. Throws InputError.
std::vector<TrueLoop> read_true_loops(const std::filesystem::path& file);

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
  double length = 0.0;  ///< m
  bool found = false;   ///< by a right edge within it
};

struct LoopScore {
  std::vector<ScoredLoop> loops;  ///< candidates both of whose keyframes the truth covers
  std::vector<Revisit> revisits;
  std::size_t accepted = 0;
  std::size_t false_ones = 0;  ///< number among the accepted
  // Among the refused, those whose submaps could be aligned:
  std::size_t right_refused = 0;  ///< measured rightly, and not accepted
  std::size_t wrong_refused = 0;  ///< measured wrongly, and not accepted
};

/// `map` is the file, for messages too. Throws InputError.
LoopScore score_loops(const std::filesystem::path& map, const Trajectory& truth,
                      const std::vector<TrueLoop>& loops);

std::string describe(const LoopScore& score);
nlohmann::ordered_json to_json(const LoopScore& score);

}  // namespace adit
