// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is known of public data sets; docs/datasets.md tells where they come from.
#pragma once

#include <string>
#include <vector>

#include "adit/slam/core/config.hpp"

namespace adit {

/// The names that apply_preset() knows, in alphabetical order.
std::vector<std::string> preset_names();

/// Sets the topics, what depends on the sensor and, where it is known, its mounting. Throws
/// UsageError for a name that is not known, with the nearest that is.
void apply_preset(const std::string& name, Config& config);

}  // namespace adit
