// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "adit/tools/drawing/geotiff_writer.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"
#include "adit/tools/plans/ground_surface.hpp"

namespace adit {

/// A number a cell.
struct HeightBand {
  RasterBand band{};
  const GroundHeights* values = nullptr;
};

/// Writes bands with cells of one size as one GeoTIFF; NaN where a band has no number. There must
/// be a cell in one of them. Throws OutputError.
void write_height_bands(const std::filesystem::path& file, std::span<const HeightBand> bands,
                        const ProductCoordinates& coordinates, const std::string& description);

}  // namespace adit
