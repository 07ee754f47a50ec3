// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "adit/slam/registration/batch_aligner.hpp"

namespace adit {

/// Where to look for a second pose that fits, and what counts as fitting as well; lengths in m.
struct CompetingPoseSettings {
  double reach = 2.0;     ///< on both sides, along the translation that is held least
  double spacing = 0.25;  ///< spacing of the scored offsets; less than the basin of an alignment
  double least_apart = 0.25;    ///< nearer poses are the same
  double least_overlap = 0.85;  ///< share of the result's overlap
  double most_rms = 1.15;       ///< times the result's residual_rms
};

/// Has more of the points matched, or as many (within 1 %) that lie nearer.
bool fits_better(const RegistrationResult& a, const RegistrationResult& b);

/// A pose that fits as well as the result: places that repeat (pillars, doors, a smooth tunnel)
/// have more than one, and which one the guess leads to says nothing.
struct CompetingPose {
  RegistrationResult result;
  double apart = 0.0;  ///< m, along the direction; negative: behind
};

/// For each pair and its result the competing pose that fits best, if there is one: offsets along
/// the least held direction are scored (one submission), and from the best peak on either side,
/// else from the farthest, alignment goes on (another). Results that are not usable or not assessed
/// have none. Errors as BatchAligner::align().
std::vector<std::optional<CompetingPose>> find_competing_poses(
    BatchAligner& aligner, std::span<const AlignmentPair> pairs,
    std::span<const RegistrationResult> results, const CompetingPoseSettings& settings = {},
    const Checkpoint& checkpoint = {});

}  // namespace adit
