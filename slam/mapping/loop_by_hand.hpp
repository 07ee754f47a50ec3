// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>

#include "adit/slam/core/config.hpp"
#include "adit/slam/loops/loop_verification.hpp"
#include "adit/slam/mapping/map_store.hpp"

namespace adit {

/// A loop that somebody says there is between two keyframes.
struct LoopByHand {
  NodeId from = 0;
  NodeId to = 0;
  /// T_from_to, to some 2 m and 10 degrees; none: as the graph has it, as well as it knows.
  std::optional<Eigen::Isometry3d> guess{};
};

/// The graph cannot tell where the two lie to each other: a guess is needed.
class NoGuess : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What alignments of consecutive submaps of a map leave, the median of up to nine, as a run has it
/// of all: rms, m. Throws what verify_by_hand() throws, but no NoGuess.
double usual_rms(engine::Context& context, const Config& config, const MapStore& store);

/// Verifies it as those are verified that were found (docs/theory/loops.md), held against the
/// `usual` rms; it does not vote. `config` is that of the keyframes' session. Throws NoGuess, what
/// the store throws, SubmapDamaged and engine::OutOfMemory.
LoopVerification verify_by_hand(engine::Context& context, const Config& config,
                                const MapStore& store, const LoopByHand& loop, double usual);

}  // namespace adit
