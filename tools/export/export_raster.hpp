// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A map from above, as numbers. Each returns what was written, for people.
#pragma once

#include <string>

#include "adit/tools/export/export_job.hpp"

namespace adit {

/// Height of the submaps' points, or intensity of the recording's, as GeoTIFF, or as PNG with a
/// world file beside it.
std::string export_raster(const ExportJob& job);

/// Colours of the surface as it is seen from above, in the same files.
std::string export_orthophoto(const ExportJob& job);

/// The YAML file that was asked for, and the PGM beside it.
std::string export_grid(const ExportJob& job);

}  // namespace adit
