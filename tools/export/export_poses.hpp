// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Trajectory, graph and picture of a map. Each returns what was written, for people.
#pragma once

#include <string>

#include "adit/tools/drawing/map_picture.hpp"
#include "adit/tools/export/export_job.hpp"

namespace adit {

std::string export_trajectory(const ExportJob& job);
std::string export_graph(const ExportJob& job);
/// The points of all submaps, thinned, with sweeps and loops over them.
std::string drawing_of(const ExportJob& job, const ProductCoordinates& coordinates,
                       const std::string& title, PictureFormat format);
/// The same as a file, in the map's frame.
std::string export_picture(const ExportJob& job, PictureFormat format);

}  // namespace adit
