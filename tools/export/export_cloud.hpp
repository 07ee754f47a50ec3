// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds of a map: of its submaps, of its recording, and in tiles. Each returns what was written,
// for people.
#pragma once

#include <string>

#include "adit/tools/export/export_job.hpp"

namespace adit {

/// Submap by submap, or tile by tile where it is thinned: memory does not grow with the map.
std::string export_cloud(const ExportJob& job);

/// Every return of the recording, from where the optimised trajectory has the sensor. Sweep by
/// sweep: memory holds one of them.
std::string export_dense(const ExportJob& job);
/// The same for whoever takes the points, in these coordinates. Returns what there was.
std::string visit_dense(const ExportJob& job, const ProductCoordinates& coordinates,
                        const CloudSelection& selection, const TakeCloud& take);

/// A file a tile, in a folder, with what Autoware's map loader asks for.
std::string export_tiles(const ExportJob& job);

}  // namespace adit
