// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/maps/cloud_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "adit/slam/core/text.hpp"
#include "adit/tools/drawing/geotiff_writer.hpp"
#include "adit/tools/drawing/png_writer.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr double kClipped = 0.02;  // share of cells beyond either end of the colours

// From low to high, of even lightness steps: those of pictures of maps.
constexpr std::array<Color, 8> kRamp{{{0x3b, 0x3f, 0x8f},
                                      {0x3a, 0x5b, 0xa0},
                                      {0x37, 0x78, 0xa8},
                                      {0x37, 0x94, 0xa6},
                                      {0x45, 0xae, 0x94},
                                      {0x6f, 0xc3, 0x78},
                                      {0xa5, 0xd0, 0x5a},
                                      {0xdc, 0xd6, 0x4a}}};

Color color_of(float share) {
  const float at = std::clamp(share, 0.0F, 1.0F) * static_cast<float>(kRamp.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kRamp.size() - 2);
  const float rest = at - static_cast<float>(below);
  Color mixed{};
  for (std::size_t i = 0; i < 3; ++i) {
    mixed[i] = static_cast<uint8_t>(
        std::lround((1.0F - rest) * kRamp[below][i] + rest * kRamp[below + 1][i]));
  }
  return mixed;
}

int64_t block_of(int64_t cell) {
  return cell / kRasterBlock - static_cast<int64_t>(cell % kRasterBlock < 0);
}

std::size_t within(int64_t column, int64_t row) {
  return static_cast<std::size_t>((row - kRasterBlock * block_of(row)) * kRasterBlock + column -
                                  kRasterBlock * block_of(column));
}

}  // namespace

CloudRaster::Index CloudRaster::index_of(const Eigen::Vector2d& place) const {
  return {static_cast<int64_t>(std::floor(place.x() / cell_)),
          static_cast<int64_t>(std::floor(place.y() / cell_))};
}

void CloudRaster::add(std::span<const CloudPoint> points) {
  for (const CloudPoint& point : points) {
    if (point.moving) {
      continue;
    }
    const Index index = index_of(point.position.head<2>());
    if (empty()) {
      low_ = index;
      high_ = index;
    }
    low_ = low_.cwiseMin(index);
    high_ = high_.cwiseMax(index);
    std::vector<Cell>& block = blocks_[{.y = block_of(index.y()), .x = block_of(index.x())}];
    if (block.empty()) {
      block.resize(std::size_t{kRasterBlock} * kRasterBlock);
    }
    Cell& cell = block[within(index.x(), index.y())];
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
  return value_ == RasterValue::intensity ? cell.sum / static_cast<float>(cell.count) : cell.sum;
}

Eigen::Vector2d CloudRaster::corner() const {
  return cell_ * Eigen::Vector2d(static_cast<double>(low_.x()), static_cast<double>(high_.y() + 1));
}

float CloudRaster::at(int64_t column, int64_t row) const {
  const Index index(low_.x() + column, high_.y() - row);
  const auto block = blocks_.find({.y = block_of(index.y()), .x = block_of(index.x())});
  return block == blocks_.end() ? kNothing : value_of(block->second[within(index.x(), index.y())]);
}

void CloudRaster::write_tiff(const std::filesystem::path& file,
                             const ProductCoordinates& coordinates) const {
  GeoTiffHeading heading{.columns = columns(),
                         .rows = rows(),
                         .cell = cell_,
                         .corner = corner(),
                         .coordinates = coordinates.name(),
                         .description = value_ == RasterValue::height
                                            ? "height of the highest point, m"
                                            : "mean intensity, the sensor's own scale",
                         .software = "adit " + std::string(version())};
  if (coordinates.frame() == ProductFrame::utm) {
    heading.epsg = epsg_of(coordinates.zone());
  } else if (coordinates.frame() == ProductFrame::local) {
    const WorldFrame& world = coordinates.world();
    heading.projection = {.latitude = world.origin().latitude,
                          .longitude = world.origin().longitude,
                          .scale = world.scale()};
  }
  std::vector<float> cells(std::size_t{kRasterBlock} * kRasterBlock);
  write_geotiff(file, heading, [&](int64_t column, int64_t row) -> std::span<const float> {
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
  for (const auto& [number, block] : blocks_) {
    for (const Cell& cell : block) {
      if (cell.count > 0) {
        values.push_back(value_of(cell));
      }
    }
  }
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
          known ? color_of(high > low ? (value - low) / (high - low) : 0.5F) : Color{};
      pixels.insert(pixels.end(),
                    {color[0], color[1], color[2], known ? uint8_t{255} : uint8_t{0}});
    }
  }
  return png_bytes_with_alpha(static_cast<int>(columns()), static_cast<int>(rows()), pixels);
}

std::string CloudRaster::world_file() const {
  const Eigen::Vector2d middle = corner() + 0.5 * cell_ * Eigen::Vector2d(1.0, -1.0);
  return shortest(cell_) + "\n0\n0\n" + shortest(-cell_) + "\n" + shortest(middle.x()) + "\n" +
         shortest(middle.y()) + "\n";
}

}  // namespace adit
