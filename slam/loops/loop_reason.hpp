// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace adit {

/// Why a place that may have been seen before has been refused, or taken back: in the order in
/// which it is asked.
enum class LoopReason {
  none,
  not_aligned,         ///< the alignment of the submaps failed
  too_little_overlap,  ///< figure: share of the points with a match
  poor_fit,            ///< figure: rms distance of the matches, m
  degenerate,          ///< no match holds some direction; figure: information in it, 1/m^2
  beyond_gate,         ///< far from where the graph has it; figure: chi squared
  ambiguous,           ///< another pose fits as well; figure: m between the two
  seen_through,        ///< one sees through what the other sees; figure: share of the points
  against_odometry,    ///< figure: chi squared
  against_loops,       ///< contradicts accepted loops; figure: the worst chi squared
  another_place,       ///< others agree that it is elsewhere; figure: later keyframes that agree
  few_votes,           ///< figure: later keyframes that agree
  review,              ///< did not fit any more after an optimisation; figure: chi squared
  by_hand,             ///< somebody has revoked it
  added_by_hand,       ///< no reason against it: somebody has added it
};
inline constexpr std::size_t kLoopReasons = static_cast<std::size_t>(LoopReason::added_by_hand) + 1;
/// The enumerator's name.
std::string_view to_string(LoopReason reason);

}  // namespace adit
