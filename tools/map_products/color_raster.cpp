// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/color_raster.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include "adit/tools/drawing/png_writer.hpp"

namespace adit {
namespace {

constexpr uint8_t kOpaque = 255;

}  // namespace

void ColorRaster::add(std::span<const CloudPoint> points) {
  std::size_t i = 0;
  while (i < points.size()) {
    const CellGrid<int>::Index index = grid_.index_of(points[i].position.head<2>());
    std::array<uint32_t, 3> sum{};
    uint32_t count = 0;
    for (; i < points.size() && grid_.index_of(points[i].position.head<2>()) == index; ++i) {
      if (points[i].color != std::array<uint8_t, 3>{}) {
        for (std::size_t k = 0; k < 3; ++k) {
          sum[k] += points[i].color[k];
        }
        ++count;
      }
    }
    if (count > 0) {
      std::array<uint8_t, 4>& cell = grid_.touch(index);
      filled_ += cell[3] == 0 ? 1U : 0U;
      for (std::size_t k = 0; k < 3; ++k) {
        cell[k] = static_cast<uint8_t>((sum[k] + count / 2) / count);
      }
      cell[3] = kOpaque;
    }
  }
}

RasterFrame ColorRaster::frame() const {
  return {.columns = grid_.columns(),
          .rows = grid_.rows(),
          .cell = grid_.size(),
          .corner = grid_.size() * Eigen::Vector2d(static_cast<double>(grid_.low().x()),
                                                   static_cast<double>(grid_.high().y() + 1))};
}

std::array<uint8_t, 4> ColorRaster::at(int64_t column, int64_t row) const {
  return grid_.at({grid_.low().x() + column, grid_.high().y() - row});
}

void ColorRaster::write_tiff(const std::filesystem::path& file,
                             const ProductCoordinates& coordinates) const {
  const GeoTiffHeading heading = geotiff_heading(
      frame(), coordinates, "colour of the highest surface whose upper side was seen");
  std::vector<uint8_t> cells(std::size_t{4} * kRasterBlock * kRasterBlock);
  write_color_geotiff(file, heading, [&](int64_t column, int64_t row) -> std::span<const uint8_t> {
    bool any = false;
    for (int64_t y = 0; y < kRasterBlock; ++y) {
      for (int64_t x = 0; x < kRasterBlock; ++x) {
        const int64_t c = column * kRasterBlock + x;
        const int64_t r = row * kRasterBlock + y;
        const bool inside = c < heading.columns && r < heading.rows;
        const std::array<uint8_t, 4> value = inside ? at(c, r) : std::array<uint8_t, 4>{};
        std::ranges::copy(value, cells.begin() + 4 * (y * kRasterBlock + x));
        any = any || value[3] > 0;
      }
    }
    return any ? std::span<const uint8_t>(cells) : std::span<const uint8_t>();
  });
}

std::string ColorRaster::png() const {
  const RasterFrame frame = this->frame();
  std::vector<uint8_t> pixels;
  pixels.reserve(static_cast<std::size_t>(4 * frame.columns * frame.rows));
  for (int64_t row = 0; row < frame.rows; ++row) {
    for (int64_t column = 0; column < frame.columns; ++column) {
      const std::array<uint8_t, 4> value = at(column, row);
      pixels.insert(pixels.end(), value.begin(), value.end());
    }
  }
  return png_bytes_with_alpha(static_cast<int>(frame.columns), static_cast<int>(frame.rows),
                              pixels);
}

}  // namespace adit
