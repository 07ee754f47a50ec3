// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Options of `adit export` for the colours of points.
#pragma once

#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/export/export_options.hpp"

namespace adit {

/// Throws UsageError where they are for something else than dense clouds.
void check_color_options(const ExportCommandOptions& options);

void add_color_options(const Command& command, ExportCommandOptions& options);

}  // namespace adit
