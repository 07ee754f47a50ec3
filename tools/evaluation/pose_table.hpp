// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// Whether the text begins with a line of column names separated by commas.
bool is_table(std::string_view text);

/// Poses of a table whose columns are found by their names: a time (timestamp, t_s, stamp_s, ...;
/// seconds, or nanoseconds where the name says ns or the number is whole and beyond 1e14), x y z
/// (m) and qx qy qz qw. Throws InputError with the line.
Trajectory read_pose_table(const std::filesystem::path& file, std::string_view text);

}  // namespace adit
