// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/tools/export/export_job.hpp"

namespace adit {

/// --elevation: the ground with its slope, steps and roughness as bands of a GeoTIFF. Returns what
/// was written, for people.
std::string export_elevation(const ExportJob& job);

}  // namespace adit
