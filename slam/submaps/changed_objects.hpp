// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "adit/slam/submaps/session_changes.hpp"

namespace adit {

/// A voxel whose log odds are at least this has changed by itself.
inline constexpr double kChangedLogOdds = 3.0;
/// One next to it has changed with it if its own votes do not speak against that.
inline constexpr double kLeastLogOdds = 0.0;

/// Voxels with the same change that touch each other, by faces, edges or corners, are one object.
/// Gives the numbers of the voxels of each object, in the order of their first voxels. An object
/// has at least `least_points` points, in voxels that have changed by themselves and in their
/// neighbours.
std::vector<std::vector<std::size_t>> changed_objects(std::span<const ChangedVoxel> voxels,
                                                      std::size_t least_points);

}  // namespace adit
