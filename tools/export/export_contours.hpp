// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The ground of a map, and its contour lines.
#pragma once

#include <string>

#include "adit/tools/export/export_job.hpp"
#include "adit/tools/plans/ground_surface.hpp"

namespace adit {

/// The ground of all storeys around the part that is wanted.
struct GroundLevelsFound {
  GroundLevels levels{};
  double size = 0.0;  ///< m, of cells
};
/// Empty where no ground was seen.
GroundLevelsFound find_ground(const ExportJob& job, const ProductCoordinates& coordinates);

/// Of the part that is wanted, in cells of `size` (m). Throws UsageError, naming `option`, where
/// there is none.
GroundHeights ground_of(const ExportJob& job, const ProductCoordinates& coordinates, double size,
                        const std::string& option);

/// --contours: lines of one height as DXF, GeoJSON or GeoPackage, by the end of the output's name.
/// Returns what was written, for people.
std::string export_contours(const ExportJob& job);

}  // namespace adit
