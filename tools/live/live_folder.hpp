// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "adit/tools/live/live_options.hpp"

namespace adit {

/// The file in OUT that what arrives goes to, of that name. One that is there is removed where
/// --overwrite is given. Throws UsageError where results or a recording are there otherwise.
std::filesystem::path prepare_recording(const RunCommandOptions& run, const std::string& name);

/// Removes what was recorded, unless it is to stay.
void end_recording(const LiveOptions& options, const std::filesystem::path& file);

}  // namespace adit
