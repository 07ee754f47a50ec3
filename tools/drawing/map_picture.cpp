// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/map_picture.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <limits>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/tools/drawing/svg.hpp"

namespace adit {
namespace {

// From low to high: dark blue over green to yellow, of even lightness steps.
constexpr std::array<std::string_view, 8> kRamp{"#2b2c6b", "#2f4b8c", "#2c6f97", "#2a9290",
                                                "#43b37c", "#86cc5c", "#c6dc3f", "#fde725"};
constexpr float kEmpty = -std::numeric_limits<float>::infinity();
constexpr double kCells = 500.0;           ///< along the longer side
constexpr std::size_t kPixelsPerCell = 2;  ///< on the screen

/// The highest point of each cell; row 0 is the northernmost.
struct Raster {
  Eigen::Vector2d low;
  double cell = 0.0;  ///< m
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<float> top;

  Eigen::Vector2d place(const Eigen::Vector2d& p) const {
    return {(p.x() - low.x()) / cell, static_cast<double>(rows) - (p.y() - low.y()) / cell};
  }
};

Raster rasterize(std::span<const Point> points, std::span<const StampedPose> path) {
  Eigen::AlignedBox2d box;
  for (const Point& p : points) {
    box.extend(Eigen::Vector2d(p.x, p.y));
  }
  for (const StampedPose& pose : path) {
    box.extend(Eigen::Vector2d(pose.pose.translation().head<2>()));
  }
  if (box.isEmpty()) {
    box.extend(Eigen::Vector2d::Zero().eval());
  }
  Raster raster;
  raster.cell = std::max(box.sizes().maxCoeff() / kCells, 0.05);
  raster.low = box.min();
  raster.columns = static_cast<std::size_t>(box.sizes().x() / raster.cell) + 1;
  raster.rows = static_cast<std::size_t>(box.sizes().y() / raster.cell) + 1;
  raster.top.assign(raster.columns * raster.rows, kEmpty);
  for (const Point& p : points) {
    const auto column = static_cast<std::size_t>((p.x - box.min().x()) / raster.cell);
    const auto row =
        raster.rows - 1 - static_cast<std::size_t>((p.y - box.min().y()) / raster.cell);
    float& top = raster.top[row * raster.columns + column];
    top = std::max(top, p.z);
  }
  return raster;
}

/// Heights that 5 % of the cells stay below and above: a lone bird does not bleach the picture.
std::pair<float, float> height_range(const Raster& raster) {
  std::vector<float> heights;
  std::ranges::copy_if(raster.top, std::back_inserter(heights),
                       [](float z) { return z != kEmpty; });
  if (heights.empty()) {
    return {0.0F, 1.0F};
  }
  std::ranges::sort(heights);
  const float low = heights[heights.size() / 20];
  const float high = heights[heights.size() - 1 - heights.size() / 20];
  return {low, std::max(high, low + 0.1F)};
}

/// One path element a colour: each run of cells is a horizontal stroke.
std::string cells(const Raster& raster) {
  const auto [low, high] = height_range(raster);
  const auto color_of = [low = low, high = high](float z) {
    const float share = (z - low) / (high - low) * static_cast<float>(kRamp.size());
    return static_cast<std::size_t>(
        std::clamp(share, 0.0F, static_cast<float>(kRamp.size()) - 1.0F));
  };
  std::array<std::ostringstream, kRamp.size()> strokes;
  for (std::size_t row = 0; row < raster.rows; ++row) {
    const float* line = &raster.top[row * raster.columns];
    for (std::size_t column = 0; column < raster.columns;) {
      if (line[column] == kEmpty) {
        ++column;
        continue;
      }
      const std::size_t color = color_of(line[column]);
      const std::size_t start = column;
      while (column < raster.columns && line[column] != kEmpty && color_of(line[column]) == color) {
        ++column;
      }
      strokes[color] << 'M' << start << ' ' << row << ".5h" << column - start;
    }
  }
  std::ostringstream text;
  for (std::size_t color = 0; color < kRamp.size(); ++color) {
    text << "<path stroke=\"" << kRamp[color] << "\" d=\"" << strokes[color].str() << "\"/>\n";
  }
  return text.str();
}

std::string polyline(const Raster& raster, std::span<const StampedPose> path) {
  std::ostringstream text;
  text << R"(<polyline fill="none" stroke="#e4342c" stroke-width="1.5" points=")";
  for (const StampedPose& pose : path) {
    const Eigen::Vector2d p = raster.place(pose.pose.translation().head<2>());
    text << tick_label(p.x(), 0.1) << ',' << tick_label(p.y(), 0.1) << ' ';
  }
  text << "\"/>\n";
  return text.str();
}

std::string scale_bar(const Raster& raster) {
  const double width = static_cast<double>(raster.columns) * raster.cell;
  const double length = round_length(std::max(width, 1.0) / 2.0);
  const double cells_long = length / raster.cell;
  std::ostringstream text;
  text << R"(<path stroke="#ffffff" stroke-width="2" d="M4 )" << raster.rows + 12 << 'h'
       << tick_label(cells_long, 0.1) << "\"/>\n"
       << R"(<text fill="#ffffff" font-family="sans-serif" font-size="9" x=")"
       << tick_label(cells_long + 8.0, 0.1) << "\" y=\"" << raster.rows + 15 << "\">"
       << tick_label(length, length) << " m</text>\n";
  return text.str();
}

}  // namespace

std::string map_picture(std::span<const Point> points, std::span<const StampedPose> path) {
  const Raster raster = rasterize(points, path);
  const std::size_t height = raster.rows + 20;  // with the scale bar below
  std::ostringstream text;
  text << R"(<svg xmlns="http://www.w3.org/2000/svg" width=")" << kPixelsPerCell * raster.columns
       << "\" height=\"" << kPixelsPerCell * height << "\" viewBox=\"0 0 " << raster.columns << ' '
       << height << "\">\n"
       << "<rect width=\"100%\" height=\"100%\" fill=\"#10101c\"/>\n<g "
          "shape-rendering=\"crispEdges\">\n"
       << cells(raster) << "</g>\n"
       << polyline(raster, path) << scale_bar(raster) << "</svg>\n";
  return text.str();
}

}  // namespace adit
