// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/free_space.hpp"

#include <algorithm>
#include <array>
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

constexpr int kQuarter = kColumns / 4;

/// Where the rows below the first and the columns of a quarter begin: what a point's pixel is
/// follows from comparisons, in a third of the time that angles take.
struct Boundaries {
  std::array<double, kRows - 1> rows{};        ///< cosines of the angles from above, descending
  std::array<double, kQuarter - 1> columns{};  ///< tangents, ascending
};

const Boundaries kBoundaries = [] {
  Boundaries boundaries;
  for (std::size_t i = 0; i < boundaries.rows.size(); ++i) {
    boundaries.rows[i] = std::cos(static_cast<double>(i + 1) * kPixel);
  }
  for (std::size_t i = 0; i < boundaries.columns.size(); ++i) {
    boundaries.columns[i] = std::tan(static_cast<double>(i + 1) * kPixel);
  }
  return boundaries;
}();

/// How many boundaries of a quarter lie at or before the direction (along, across), both positive.
int column_of_quarter(double along, double across) {
  const auto passed = [&](double tangent) { return across >= along * tangent; };
  return static_cast<int>(std::ranges::partition_point(kBoundaries.columns, passed) -
                          kBoundaries.columns.begin());
}

/// Columns begin behind, at -x.
int column_of(double x, double y) {
  if (x < 0.0 && y <= 0.0) {
    return column_of_quarter(-x, -y);
  }
  if (x >= 0.0 && y < 0.0) {
    return kQuarter + column_of_quarter(-y, x);
  }
  if (x > 0.0) {
    return 2 * kQuarter + column_of_quarter(x, y);
  }
  return y > 0.0 ? 3 * kQuarter + column_of_quarter(y, -x) : 2 * kQuarter;
}

std::optional<Pixel> pixel_of(const Eigen::Vector3d& point, double range) {
  if (!(range > kNearest)) {
    return std::nullopt;
  }
  const double height = point.z() / range;
  const auto below = [&](double cosine) { return height <= cosine; };
  const auto row = std::ranges::partition_point(kBoundaries.rows, below);
  return Pixel{static_cast<int>(row - kBoundaries.rows.begin()), column_of(point.x(), point.y())};
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
  const double range = point.norm();
  if (const auto pixel = pixel_of(point, range)) {
    float& nearest = nearest_[index(pixel->row, pixel->column)];
    nearest = std::min(nearest, static_cast<float>(range));
  }
}

RangeImage::Sight RangeImage::at(const Eigen::Vector3d& point) const {
  const double range = point.norm();
  const auto pixel = pixel_of(point, range);
  if (!pixel || nearest_[index(pixel->row, pixel->column)] == kNothing) {
    return Sight::unknown;
  }
  float nearest = kNothing;
  int pixels = 0;
  for (int row = std::max(pixel->row - 1, 0); row <= std::min(pixel->row + 1, kRows - 1); ++row) {
    for (int column = pixel->column - 1; column <= pixel->column + 1; ++column) {
      const float seen = nearest_[index(row, column)];
      nearest = std::min(nearest, seen);
      pixels += seen == kNothing ? 0 : 1;
    }
  }
  if (pixels < kLeastPixels) {
    return Sight::unknown;
  }
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
