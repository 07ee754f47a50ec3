// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/slam/odometry/rejection.hpp"

namespace adit {

/// In whole hundredths.
std::string percent(double share);

/// Why an alignment is rejected, for people.
std::string describe(const Rejection& rejection);

}  // namespace adit
