// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The mean velocity from one pose of another odometry to the next, in the axes that the child
/// frame has halfway, stamped with the middle. Nothing where the second is not later, or later by
/// more than a second.
std::optional<BodyVelocity> velocity_between(const ReferencePose& from, const ReferencePose& to);

/// The events, with velocities in place of the poses of one topic. Where the other odometry drifts
/// to does not matter then, and a leap of it is one wrong velocity.
std::unique_ptr<EventStream> with_velocities_of_poses(std::unique_ptr<EventStream> events,
                                                      std::size_t topic);

}  // namespace adit
