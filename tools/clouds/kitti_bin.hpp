// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// Reads a sweep of KITTI: float32 x y z intensity, one point after the other. Its stamp is 0.
/// Throws InputError where the file is no whole number of points.
Sweep read_kitti_bin(const std::filesystem::path& file);

}  // namespace adit
