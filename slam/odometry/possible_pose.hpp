// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "adit/slam/core/types.hpp"
#include "adit/slam/odometry/rejection.hpp"

namespace adit {

/// Why nothing that was at `last` can be there; none: it can. `max_speed` in m/s.
std::optional<Rejection> impossible_pose(const StampedPose& pose,
                                         const std::optional<StampedPose>& last, double max_speed);

}  // namespace adit
