// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/executor/measurement_gate.hpp"

namespace adit {

/// One sentence a kind of fault, without its end: "2 of 60 fixes are not finite and were left out".
std::vector<std::string> describe(const MeasurementFaults& faults);

/// The "not_finite" of summary.json: counts by kind.
nlohmann::ordered_json to_json(const MeasurementFaults& faults);

}  // namespace adit
