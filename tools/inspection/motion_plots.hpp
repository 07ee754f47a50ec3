// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a recording alone tells of its motion, drawn for the page of `adit inspect`.
#pragma once

#include <optional>
#include <string>

#include "adit/tools/inspection/inspection.hpp"

namespace adit {

/// Rates, times at rest with the biases in them, the size of acceleration and which way is up over
/// the time since the first reading, as an SVG of that width (px); empty without readings.
/// `R_range_imu` tells up in the axes of the range sensor, otherwise it is in those of the IMU.
std::string draw_imu(const ImuStatistics& imu, const std::optional<Eigen::Matrix3d>& R_range_imu,
                     double width);

/// How both sensors turned from sweep to sweep, and what they differ by, as an SVG; empty where
/// they could not be compared.
std::string draw_turns(const MotionCheck& check, double width);

}  // namespace adit
