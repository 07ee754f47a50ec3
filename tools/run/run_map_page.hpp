// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The page that shows a run's map, OUT/map.html.
#pragma once

#include <string>

#include "adit/tools/results/page_cloud.hpp"
#include "adit/tools/results/run_outputs.hpp"

namespace adit {

/// From the trajectory and the table that the run has left, and the cloud it has gathered. Throws
/// OutputError, and InputError where somebody has changed the files meanwhile.
void write_map_page(const RunFiles& files, const PageCloud& cloud, const std::string& recording);

}  // namespace adit
