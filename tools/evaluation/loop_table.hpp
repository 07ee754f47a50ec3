// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Tables of loops, as CSV with named columns.
#pragma once

#include <filesystem>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// A pair of moments that see the same, as the simulator writes them.
struct TrueLoop {
  Nanoseconds earlier{0};
  Nanoseconds later{0};
  double distance = 0.0;  ///< m
  double overlap = 0.0;
};

/// Reads a table with the columns time_a_s, time_b_s, distance_m and overlap; empty lines are
/// passed over. Throws InputError.
std::vector<TrueLoop> read_true_loops(const std::filesystem::path& file);

/// A closure as a system measured it.
struct MeasuredLoop {
  Nanoseconds earlier{0};
  Nanoseconds later{0};
  Eigen::Isometry3d T_earlier_later = Eigen::Isometry3d::Identity();  ///< of the range sensor
};

/// Reads a table with the columns time_a_s, time_b_s, x, y, z (m), qx, qy, qz and qw, in the same
/// way.
std::vector<MeasuredLoop> read_measured_loops(const std::filesystem::path& file);

}  // namespace adit
