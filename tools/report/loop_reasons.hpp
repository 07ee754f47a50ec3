// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/loops/loop_reason.hpp"

namespace adit {

/// Candidates by the reason that they were refused for, or taken back.
using LoopReasonCounts = std::array<std::size_t, kLoopReasons>;

/// "12 too_little_overlap, 3 few_votes", in the order in which it is asked, without what is 0.
std::string reasons_text(const LoopReasonCounts& counts);

/// The same, by the reason's name.
nlohmann::ordered_json reasons_to_json(const LoopReasonCounts& counts);

}  // namespace adit
