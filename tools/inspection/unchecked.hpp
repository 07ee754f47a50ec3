// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adit/tools/inspection/inspection.hpp"

namespace adit {

/// What an inspection could not check, each with its reason: topics of types that are not read,
/// clock and mounting of an IMU where no device, no gyroscope or no motion tells them, times of
/// points that are not there. Empty where all was checked.
std::vector<std::string> unchecked(const Inspection& inspection);

/// "no fault found", or "no fault found; not checked: ...", or, beside problems, "not checked:
/// ..."; empty where there is nothing to say.
std::string conclusion(const Inspection& inspection);

}  // namespace adit
