// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/tools/inspection/inspection.hpp"

namespace adit {

/// The inspection as one HTML page that needs nothing else: findings, topics, what was inferred,
/// and for every topic its rate over time with its gaps, how long its intervals are, and how its
/// clock runs against the recorder's; of an IMU its rates, times at rest, gravity, and how it
/// turned against the sweeps, with the directions that these hold.
std::string inspection_page(const Inspection& inspection);

}  // namespace adit
