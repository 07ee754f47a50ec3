// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Plans of a map: slices, sections, and a floor plan for each storey.
#pragma once

#include <string>

#include "adit/tools/export/export_job.hpp"

namespace adit {

/// --slice and --section: one drawing, or one raster of the points in the slice. Returns what was
/// written, for people.
std::string export_slice(const ExportJob& job);

/// --plan: a file for each storey beside the one that was asked for, FILE_0 and so on. Returns what
/// was written, a line for each with its end.
std::string export_plan(const ExportJob& job);

/// FILE_N of a storey.
std::filesystem::path file_of_storey(const std::filesystem::path& file, std::size_t storey);

}  // namespace adit
