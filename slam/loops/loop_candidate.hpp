// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "adit/slam/core/types.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// What became of a candidate.
enum class CandidateVerdict {
  waiting,
  accepted,
  rejected,
  revoked,  ///< accepted once; its edge is revoked
};
/// The enumerator's name.
constexpr std::string_view to_string(CandidateVerdict verdict) {
  switch (verdict) {
    case CandidateVerdict::waiting:
      return "waiting";
    case CandidateVerdict::accepted:
      return "accepted";
    case CandidateVerdict::rejected:
      return "rejected";
    case CandidateVerdict::revoked:
      return "revoked";
  }
  return "unknown";
}

/// How a place that might have been seen before was found.
enum class LoopSource {
  position,    ///< by where the graph has it
  appearance,  ///< by what it looks like
  hand,        ///< somebody knew of it
};
/// The enumerator's name.
constexpr std::string_view to_string(LoopSource source) {
  return source == LoopSource::position     ? "position"
         : source == LoopSource::appearance ? "appearance"
                                            : "hand";
}

/// A place that might have been seen before, and what became of that.
struct LoopCandidate {
  int64_t id = 0;   ///< given by the store
  NodeId from = 0;  ///< earlier keyframe
  NodeId to = 0;    ///< later one
  Eigen::Isometry3d T_from_to =
      Eigen::Isometry3d::Identity();         ///< as verified, or as guessed before
  LoopSource source = LoopSource::position;  ///< how it was found
  double score = 0.0;                        ///< LoopPlace::score that it was found with
  double overlap = 0.0;                      ///< share of the later submap's points with a match
  double chi2 = 0.0;                         ///< correction's; after acceptance that of its edge
  CandidateVerdict verdict = CandidateVerdict::waiting;  ///< what became of it
  std::string reason;                                    ///< the name of a LoopReason
  double rms = 0.0;                                      ///< m, of the matches
  double correction = 0.0;                               ///< m, of the pose that the graph had
  double turn = 0.0;                                     ///< rad
  double through = 0.0;  ///< share of points that the other submap sees through
  double figure = 0.0;   ///< what the reason turns on, see LoopReason; accepted: votes
};

}  // namespace adit
