// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>

namespace adit {
namespace {

constexpr int kColumns = 180;
constexpr int kRows = 90;
constexpr double kPixel = std::numbers::pi / kRows;  // rad
constexpr double kNearest = 1.0;                     // m: what carries the sensor
// What surfaces and poses may be off by: m, and a share of the range.
constexpr double kMargin = 0.5;
constexpr double kMarginShare = 0.05;
constexpr float kNothing = std::numeric_limits<float>::infinity();
constexpr int kLeastPixels = 5;  // out of nine, with something in them

struct Pixel {
  int row = 0;
  int column = 0;
};

std::optional<Pixel> pixel_of(const Eigen::Vector3d& point) {
  const double range = point.norm();
  if (!(range > kNearest)) {
    return std::nullopt;
  }
  const double down = std::acos(std::clamp(point.z() / range, -1.0, 1.0));
  const double around = std::atan2(point.y(), point.x()) + std::numbers::pi;
  return Pixel{std::clamp(static_cast<int>(down / kPixel), 0, kRows - 1),
               std::clamp(static_cast<int>(around / kPixel), 0, kColumns - 1)};
}

std::size_t index(int row, int column) {
  return static_cast<std::size_t>(row * kColumns + (column + kColumns) % kColumns);
}

}  // namespace

RangeImage::RangeImage(const KeyframeSubmap& submap)
    : nearest_(static_cast<std::size_t>(kRows * kColumns), kNothing) {
  for (const SubmapPoint& point : submap.points) {
    const Eigen::Vector3d place = point.position();
    if (const auto pixel = pixel_of(place)) {
      float& nearest = nearest_[index(pixel->row, pixel->column)];
      nearest = std::min(nearest, static_cast<float>(place.norm()));
    }
  }
}

RangeImage::Sight RangeImage::at(const Eigen::Vector3d& point) const {
  const auto pixel = pixel_of(point);
  if (!pixel || nearest_[index(pixel->row, pixel->column)] == kNothing) {
    return Sight::unknown;
  }
  float nearest = kNothing;
  int pixels = 0;
  for (int row = std::max(pixel->row - 1, 0); row <= std::min(pixel->row + 1, kRows - 1); ++row) {
    for (int column = pixel->column - 1; column <= pixel->column + 1; ++column) {
      const float range = nearest_[index(row, column)];
      nearest = std::min(nearest, range);
      pixels += range == kNothing ? 0 : 1;
    }
  }
  if (pixels < kLeastPixels) {
    return Sight::unknown;
  }
  const double range = point.norm();
  return range + std::max(kMargin, kMarginShare * range) < nearest ? Sight::seen_through
                                                                   : Sight::as_seen;
}

double seen_through(const RangeImage& seen_by, const KeyframeSubmap& submap,
                    const Eigen::Isometry3d& T_by_submap) {
  std::size_t known = 0;
  std::size_t through = 0;
  for (const SubmapPoint& point : submap.points) {
    const RangeImage::Sight sight = seen_by.at(T_by_submap * point.position());
    known += sight == RangeImage::Sight::unknown ? 0U : 1U;
    through += sight == RangeImage::Sight::seen_through ? 1U : 0U;
  }
  return known == 0 || 10 * known < submap.points.size()
             ? 0.0
             : static_cast<double>(through) / static_cast<double>(known);
}

}  // namespace adit
