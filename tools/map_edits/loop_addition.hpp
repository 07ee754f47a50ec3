// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

#include "adit/slam/mapping/loop_by_hand.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_edits/loop_change.hpp"

namespace adit {

/// verify_by_hand() on some device.
using VerifyLoop = std::function<LoopVerification(const MapDatabase&, const LoopByHand&)>;

/// Lets a loop in between two keyframes, whichever is the earlier one, where it verifies and does
/// not contradict the rest of the graph, and optimises the map. The map changes as a whole or not
/// at all; change_loop() takes the loop back. Throws UsageError: no such keyframes, a loop between
/// the two that is known, or a guess that is needed; InputError: there is no such loop, the map is
/// damaged, or its graph cannot be optimised; LockedError; OutputError; what `verify` throws.
LoopChange add_loop(const std::filesystem::path& map, LoopByHand loop, const VerifyLoop& verify);

}  // namespace adit
