// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "adit/slam/gnss/world_fit.hpp"

namespace adit {

/// A receiver goes on from another place: its positions agree with the map before and after, each
/// by themselves, but not with each other. Another base station or datum does that.
struct ReceiverJump {
  double time = 0.0;       ///< s, of the first pair after it, as PositionPair::time
  double distance = 0.0;   ///< m, horizontally
  std::size_t before = 0;  ///< pairs up to it
  std::size_t after = 0;   ///< and from it on
};

/// The jump that explains which pairs agree with a fit to some of them; nothing where none does.
/// `pairs` in the order of time, `fit` from fit_world().
std::optional<ReceiverJump> find_jump(std::span<const PositionPair> pairs, const WorldFit& fit);

}  // namespace adit
