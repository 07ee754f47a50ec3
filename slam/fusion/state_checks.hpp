// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Bounds that no sensor goes beyond.
#pragma once

#include <optional>

#include "adit/slam/fusion/inertial_event.hpp"
#include "adit/slam/fusion/sliding_graph.hpp"

namespace adit {

/// What cannot be of a prediction, held against the state that it starts from; none where it can.
std::optional<ImpossibleState> impossible_motion(const NavState& from,
                                                 const StateEstimate& prediction);

/// What cannot be of a state, held against the one before where there is one; none where it can.
std::optional<ImpossibleState> impossible_state(const StateEstimate& estimate,
                                                const std::optional<NavState>& before);

}  // namespace adit
