// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/cloud_raster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adit/tools/drawing/image_canvas.hpp"
#include "adit/tools/drawing/png_writer.hpp"
#include "adit/tools/drawing/svg.hpp"

namespace adit {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr double kClipped = 0.02;  // share of cells beyond either end of the colours

Color ramp_color(float share) {
  const float at = std::clamp(share, 0.0F, 1.0F) * static_cast<float>(kRampColors.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kRampColors.size() - 2);
  const float rest = at - static_cast<float>(below);
  const Color lower = color_of(kRampColors[below]);
  const Color upper = color_of(kRampColors[below + 1]);
  Color mixed{};
  for (std::size_t i = 0; i < 3; ++i) {
    mixed[i] = static_cast<uint8_t>(std::lround((1.0F - rest) * lower[i] + rest * upper[i]));
  }
  return mixed;
}

const char* description_of(RasterValue value) {
  return value == RasterValue::height   ? "height of the highest point, m"
         : value == RasterValue::ground ? "height of the ground, m"
         : value == RasterValue::points ? "number of points"
                                        : "mean intensity, the sensor's own scale";
}

}  // namespace

void CloudRaster::add(std::span<const CloudPoint> points) {
  for (const CloudPoint& point : points) {
    if (point.moving) {
      continue;
    }
    Cell& cell = grid_.touch(grid_.index_of(point.position.head<2>()));
    const auto z = static_cast<float>(point.position.z());
    if (value_ == RasterValue::intensity) {
      cell.sum += point.intensity;
    } else {
      cell.sum = cell.count == 0 ? z : std::max(cell.sum, z);
    }
    filled_ += cell.count == 0 ? 1U : 0U;
    ++cell.count;
  }
}

float CloudRaster::value_of(const Cell& cell) const {
  if (cell.count == 0) {
    return kNothing;
  }
  switch (value_) {
    case RasterValue::intensity:
      return cell.sum / static_cast<float>(cell.count);
    case RasterValue::points:
      return static_cast<float>(cell.count);
    case RasterValue::height:
    case RasterValue::ground:
      break;
  }
  return cell.sum;
}

Eigen::Vector2d CloudRaster::corner() const {
  return grid_.size() * Eigen::Vector2d(static_cast<double>(grid_.low().x()),
                                        static_cast<double>(grid_.high().y() + 1));
}

float CloudRaster::at(int64_t column, int64_t row) const {
  return value_of(grid_.at({grid_.low().x() + column, grid_.high().y() - row}));
}

void CloudRaster::write_tiff(const std::filesystem::path& file,
                             const ProductCoordinates& coordinates) const {
  const GeoTiffHeading heading = geotiff_heading(frame(), coordinates, description_of(value_));
  std::vector<float> cells(std::size_t{kRasterBlock} * kRasterBlock);
  write_geotiff(file, heading,
                [&](std::size_t, int64_t column, int64_t row) -> std::span<const float> {
                  bool any = false;
                  for (int64_t y = 0; y < kRasterBlock; ++y) {
                    for (int64_t x = 0; x < kRasterBlock; ++x) {
                      const int64_t c = column * kRasterBlock + x;
                      const int64_t r = row * kRasterBlock + y;
                      const float value = c < columns() && r < rows() ? at(c, r) : kNothing;
                      cells[static_cast<std::size_t>(y * kRasterBlock + x)] = value;
                      any = any || !std::isnan(value);
                    }
                  }
                  return any ? std::span<const float>(cells) : std::span<const float>();
                });
}

std::string CloudRaster::png() const {
  std::vector<float> values;
  values.reserve(filled_);
  grid_.for_each([&](const Cell& cell) {
    if (cell.count > 0) {
      values.push_back(value_of(cell));
    }
  });
  const auto ranked = [&](double share) {
    if (values.empty()) {
      return 0.0F;
    }
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, at);
    return *at;
  };
  const float low = ranked(kClipped);
  const float high = ranked(1.0 - kClipped);
  std::vector<uint8_t> pixels;
  pixels.reserve(static_cast<std::size_t>(4 * columns() * rows()));
  for (int64_t row = 0; row < rows(); ++row) {
    for (int64_t column = 0; column < columns(); ++column) {
      const float value = at(column, row);
      const bool known = !std::isnan(value);
      const Color color =
          known ? ramp_color(high > low ? (value - low) / (high - low) : 0.5F) : Color{};
      pixels.insert(pixels.end(),
                    {color[0], color[1], color[2], known ? uint8_t{255} : uint8_t{0}});
    }
  }
  return png_bytes_with_alpha(static_cast<int>(columns()), static_cast<int>(rows()), pixels);
}

}  // namespace adit
