// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/slam/odometry/doubt.hpp"

namespace adit {

/// Why an alignment is not believed, for people.
std::string describe(const Doubt& doubt);

}  // namespace adit
