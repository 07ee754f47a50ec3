// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <pybind11/pybind11.h>

#include "adit/slam/core/types.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit::python {

using Poses = std::vector<StampedPose>;

/// Poses as an adit.Trajectory; parts begin at these.
Trajectory poses_of(Poses poses, std::vector<std::size_t> parts);

/// adit.Trajectory, adit.evaluate.
void bind_trajectories(pybind11::module_& module);

}  // namespace adit::python
