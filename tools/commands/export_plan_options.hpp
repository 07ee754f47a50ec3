// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit export` is asked for plans with.
#pragma once

#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/export/export_options.hpp"

namespace adit {

void add_plan_options(const Command& command, ExportCommandOptions& options);

/// A slice, a section or a plan is wanted, and one as raster.
bool is_plan(const ExportCommandOptions& options);
bool is_plan_raster(const ExportCommandOptions& options);

/// Throws UsageError where these do not go together, or would write over what is read.
void check_plan_options(const ExportCommandOptions& options);

}  // namespace adit
