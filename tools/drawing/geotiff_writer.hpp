// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Rasters of numbers as GeoTIFF. libgeotiff would do it as well, but brings libtiff and all that
// this can pack with into the package (tools/package.sh): ten libraries for one kind of file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace adit {

/// Cells of a side of a GeoTIFF's blocks.
inline constexpr int kRasterBlock = 256;

/// A transverse Mercator projection on WGS 84 with its origin at (0, 0).
struct TransverseMercatorKeys {
  double latitude = 0.0;   ///< degrees
  double longitude = 0.0;  ///< degrees
  double scale = 1.0;
};

/// As GDAL reads it: letters, digits and '_'.
struct RasterBand {
  std::string name{};
  std::string unit{};
};

struct GeoTiffHeading {
  int64_t columns = 0;
  int64_t rows = 0;
  double cell = 1.0;                                   ///< m
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();    ///< m, upper left one of the upper left cell
  std::optional<int> epsg{};                           ///< of the projected system
  std::optional<TransverseMercatorKeys> projection{};  ///< where it has no number
  std::string coordinates{};                           ///< for people
  std::vector<RasterBand> bands{};                     ///< empty: one without a name
  std::string description{};
  std::string software{};
};

/// The block of a band's cells row by row from the top, kRasterBlock squared of them; empty: no
/// data there.
using RasterBlock =
    std::function<std::span<const float>(std::size_t band, int64_t column, int64_t row)>;

/// The same of four bytes a cell: red, green, blue and opacity, 0 where nothing is known.
using ColorBlock = std::function<std::span<const uint8_t>(int64_t column, int64_t row)>;

/// Writes a raster of single precision, packed with deflate, "no data" being NaN. Blocks are asked
/// for once each, band by band and row by row. Same raster, same bytes. Throws OutputError, also
/// where the file would be larger than the 4 GiB that a TIFF can be.
void write_geotiff(const std::filesystem::path& file, const GeoTiffHeading& heading,
                   const RasterBlock& block);

/// The same of colours, 8 bits a channel. "No data" is an opacity of 0.
void write_color_geotiff(const std::filesystem::path& file, const GeoTiffHeading& heading,
                         const ColorBlock& block);

}  // namespace adit
