// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "adit/slam/core/types.hpp"

namespace adit {

/// Why nothing that was at `last` can be there, for people; none: it can. `max_speed` in m/s.
std::optional<std::string> impossible_pose(const StampedPose& pose,
                                           const std::optional<StampedPose>& last,
                                           double max_speed);

}  // namespace adit
