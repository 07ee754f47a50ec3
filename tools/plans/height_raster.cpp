// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/height_raster.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <vector>

#include "adit/tools/map_products/raster_frame.hpp"

namespace adit {
namespace {

struct CellBounds {
  GroundHeights::Index low{};
  GroundHeights::Index high{};
};

CellBounds bounds_of(std::span<const HeightBand> bands) {
  constexpr int64_t kMost = std::numeric_limits<int64_t>::max();
  CellBounds bounds{.low = {kMost, kMost}, .high = {-kMost, -kMost}};
  for (const HeightBand& band : bands) {
    for (const auto& [cell, value] : band.values->cells()) {
      for (std::size_t i = 0; i < 2; ++i) {
        bounds.low[i] = std::min(bounds.low[i], cell[i]);
        bounds.high[i] = std::max(bounds.high[i], cell[i]);
      }
    }
  }
  if (bounds.low[0] > bounds.high[0]) {
    throw std::logic_error("write_height_bands: no band has a cell");
  }
  return bounds;
}

}  // namespace

void write_height_bands(const std::filesystem::path& file, std::span<const HeightBand> bands,
                        const ProductCoordinates& coordinates, const std::string& description) {
  const CellBounds bounds = bounds_of(bands);
  const double cell = bands.front().values->size();
  const RasterFrame frame{
      .columns = bounds.high[1] - bounds.low[1] + 1,
      .rows = bounds.high[0] - bounds.low[0] + 1,
      .cell = cell,
      .corner = cell * Eigen::Vector2d(static_cast<double>(bounds.low[1]),
                                       static_cast<double>(bounds.high[0] + 1))};
  GeoTiffHeading heading = geotiff_heading(frame, coordinates, description);
  for (const HeightBand& band : bands) {
    heading.bands.push_back(band.band);
  }
  std::vector<float> cells(std::size_t{kRasterBlock} * kRasterBlock);
  write_geotiff(file, heading,
                [&](std::size_t band, int64_t column, int64_t row) -> std::span<const float> {
                  std::ranges::fill(cells, std::numeric_limits<float>::quiet_NaN());
                  bool any = false;
                  const auto& values = bands[band].values->cells();
                  const int64_t left = bounds.low[1] + column * kRasterBlock;
                  for (int64_t r = 0; r < kRasterBlock; ++r) {
                    const int64_t y = bounds.high[0] - row * kRasterBlock - r;
                    const auto end = values.lower_bound({y, left + kRasterBlock});
                    for (auto at = values.lower_bound({y, left}); at != end; ++at) {
                      cells[static_cast<std::size_t>(r * kRasterBlock + at->first[1] - left)] =
                          static_cast<float>(at->second);
                      any = true;
                    }
                  }
                  return any ? std::span<const float>(cells) : std::span<const float>();
                });
}

}  // namespace adit
