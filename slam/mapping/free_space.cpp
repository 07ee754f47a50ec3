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
constexpr std::size_t kMostSights = 16;
constexpr int kLeastThrough = 2;  // sweeps

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

RangeImage::RangeImage() : nearest_(static_cast<std::size_t>(kRows * kColumns), kNothing) {}

RangeImage::RangeImage(const KeyframeSubmap& submap) : RangeImage() {
  for (const SubmapPoint& point : submap.points) {
    if (!point.seen_through) {
      add(point.position());
    }
  }
}

RangeImage::RangeImage(std::span<const Point> cloud) : RangeImage() {
  for (const Point& point : cloud) {
    add({point.x, point.y, point.z});
  }
}

void RangeImage::add(const Eigen::Vector3d& point) {
  if (const auto pixel = pixel_of(point)) {
    float& nearest = nearest_[index(pixel->row, pixel->column)];
    nearest = std::min(nearest, static_cast<float>(point.norm()));
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
  const double margin = std::max(kMargin, kMarginShare * range);
  return range + margin < nearest   ? Sight::seen_through
         : range - margin > nearest ? Sight::hidden
                                    : Sight::as_seen;
}

void SweepSights::add(uint32_t sweep, std::span<const Point> cloud) {
  if (sweep % stride_ != 0) {
    return;
  }
  if (seen_.size() == kMostSights) {
    stride_ *= 2;
    std::erase_if(seen_, [&](const Seen& one) { return one.sweep % stride_ != 0; });
    add(sweep, cloud);
    return;
  }
  seen_.push_back({.sweep = sweep, .image = RangeImage(cloud)});
}

void SweepSights::clear() {
  seen_.clear();
  stride_ = 1;
}

std::vector<bool> SweepSights::see_through(std::span<const Eigen::Vector3d> points,
                                           std::span<const SubmapSweep> sweeps) const {
  std::vector<Eigen::Isometry3d> T_lidar_keyframe;
  for (const Seen& one : seen_) {
    T_lidar_keyframe.push_back(sweeps[one.sweep].T_keyframe_lidar.inverse());
  }
  const auto sees_through = [&](const Eigen::Vector3d& point) {
    int through = 0;
    int seen = 0;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const RangeImage::Sight sight = seen_[i].image.at(T_lidar_keyframe[i] * point);
      through += sight == RangeImage::Sight::seen_through ? 1 : 0;
      seen += sight == RangeImage::Sight::as_seen ? 1 : 0;
      const auto left = static_cast<int>(seen_.size() - i) - 1;
      if (through + left < kLeastThrough || through + left <= seen) {
        return false;  // whatever the others see
      }
    }
    return through >= kLeastThrough && through > seen;
  };
  std::vector<bool> result;
  result.reserve(points.size());
  for (const Eigen::Vector3d& point : points) {
    result.push_back(sees_through(point));
  }
  return result;
}

double seen_through(const RangeImage& seen_by, const KeyframeSubmap& submap,
                    const Eigen::Isometry3d& T_by_submap) {
  std::size_t known = 0;
  std::size_t through = 0;
  for (const SubmapPoint& point : submap.points) {
    if (point.seen_through) {
      continue;
    }
    const RangeImage::Sight sight = seen_by.at(T_by_submap * point.position());
    known += sight == RangeImage::Sight::unknown ? 0U : 1U;
    through += sight == RangeImage::Sight::seen_through ? 1U : 0U;
  }
  return known == 0 || 10 * known < submap.points.size()
             ? 0.0
             : static_cast<double>(through) / static_cast<double>(known);
}

}  // namespace adit
