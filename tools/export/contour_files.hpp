// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Contour lines as files of other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/tools/map_products/product_coordinates.hpp"
#include "adit/tools/plans/contour_lines.hpp"

namespace adit {

/// Lines in product coordinates.
struct ContourSheet {
  const std::vector<ContourLine>* lines = nullptr;
  double step = 1.0;  ///< m; each fifth line is an index contour
  const ProductCoordinates* coordinates = nullptr;
};

std::string contours_dxf(const ContourSheet& sheet);
/// RFC 7946: LineStrings of longitude and latitude on WGS 84. Heights are properties, since they
/// may be above a geoid. Needs a georeference.
std::string contours_geojson(const ContourSheet& sheet);
/// The layer `contours`, in the product's plane; without one in metres of no known place. Throws
/// what SQLite throws.
void write_contours_geopackage(const std::filesystem::path& file, const ContourSheet& sheet);

}  // namespace adit
