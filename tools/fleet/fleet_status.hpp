// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/tools/fleet/fleet_plan.hpp"

namespace adit {

/// Where a plan stands, for people: a line a stage, and each failure with its reason and its log.
std::string describe_fleet(const FleetPlan& plan);
/// The same as JSON, with each shard (docs/schemas/fleet.schema.json).
std::string fleet_json(const FleetPlan& plan);

}  // namespace adit
