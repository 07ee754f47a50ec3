// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit merge` reports.
#pragma once

#include <cstddef>
#include <string>

#include "adit/tools/map_merge/merge_job.hpp"

namespace adit {

/// Why a map stays apart, a sentence without its subject. `accepted`: the most of its keyframes
/// that a search has tied.
std::string reason_apart(const MapApart& apart, std::size_t accepted);

/// The table for people.
std::string describe(const MergeCommandOptions& options, const MergeOutcome& outcome);
/// docs/schemas/merge.schema.json.
std::string to_json(const MergeCommandOptions& options, const MergeOutcome& outcome);

}  // namespace adit
