// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/tools/fleet/fleet_plan.hpp"

namespace adit {

/// The same shards with the memory and the time that each will take, by the size of the recordings:
/// as shards of this plan that are done took, or else as measured once (docs/fleets.md).
std::vector<Shard> estimated(const FleetPlan& plan);

}  // namespace adit
