// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/ground_planes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Cholesky>

namespace adit {
namespace {

// m: a point of the ground is no farther from its plane. More than three standard deviations of a
// return and of what is rough or stepped in a cell, less than what people call an object.
constexpr double kThickness = 0.1;

// Cells to each side of one that its plane is fitted to: 1.25 m in all, so that the foot of a wall,
// which rises in one or two of them, is the lesser part.
constexpr int64_t kFitReach = 3;
// m: cells that are so much above the plane have half the weight.
constexpr double kHalfWeight = 0.05;
constexpr int kFits = 5;

/// Height and slopes of a plane through places by least squares, in which those above it have less
/// weight the higher they are (Kraus and Pfeifer 1998, whose weights these are).
Eigen::Vector3d lowest_plane(const std::vector<Eigen::Vector3d>& places) {
  // Keeps the plane level where it has no neighbouring cells.
  constexpr double kLevel = 1e-3;
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  for (int fit = 0; fit < kFits; ++fit) {
    Eigen::Matrix3d information = Eigen::Vector3d(0.0, kLevel, kLevel).asDiagonal();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& place : places) {
      const Eigen::Vector3d row(1.0, place.x(), place.y());
      const double above = std::max(0.0, place.z() - row.dot(plane));
      const double weight = fit == 0 ? 1.0 : 1.0 / (1.0 + std::pow(above / kHalfWeight, 4));
      information += weight * row * row.transpose();
      right += weight * place.z() * row;
    }
    plane = information.ldlt().solve(right);
  }
  return plane;
}

uint64_t key_of(const GroundHeights::Index& cell) {
  return (static_cast<uint64_t>(cell[0]) << 32U) ^ (static_cast<uint64_t>(cell[1]) & 0xffffffffU);
}

}  // namespace

GroundPlanes::GroundPlanes(const GroundLevels& levels, double size) : grid_(size) {
  for (const auto& [cell, heights] : levels) {
    cells_[key_of(cell)] = {static_cast<uint32_t>(planes_.size()),
                            static_cast<uint16_t>(heights.size())};
    for (const double height : heights) {
      planes_.push_back(fitted(levels, cell, height));
    }
  }
  spread(levels);
}

GroundPlanes::Plane GroundPlanes::fitted(const GroundLevels& levels,
                                         const GroundHeights::Index& cell, double height) const {
  std::vector<Eigen::Vector3d> places;  // from the middle of the cell, at its height
  for (int64_t y = -kFitReach; y <= kFitReach; ++y) {
    for (int64_t x = -kFitReach; x <= kFitReach; ++x) {
      const auto beside = levels.find({cell[0] + y, cell[1] + x});
      if (beside == levels.end()) {
        continue;
      }
      const double near = *std::ranges::min_element(
          beside->second, {}, [&](double other) { return std::abs(other - height); });
      const Eigen::Vector2d place =
          grid_.size() * Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y));
      if (std::abs(near - height) <= place.norm() + kGroundStep) {
        places.emplace_back(place.x(), place.y(), near - height);
      }
    }
  }
  const Eigen::Vector3d plane = lowest_plane(places);
  return {.height = static_cast<float>(height + plane.x()),
          .slope_x = static_cast<float>(plane.y()),
          .slope_y = static_cast<float>(plane.z())};
}

void GroundPlanes::spread(const GroundLevels& levels) {
  struct Source {
    int64_t distance = 0;  ///< cells, squared
    Range planes{};
  };
  std::map<GroundHeights::Index, Source> added;
  for (const auto& [cell, heights] : levels) {
    for (int64_t y = -kGroundGap; y <= kGroundGap; ++y) {
      for (int64_t x = -kGroundGap; x <= kGroundGap; ++x) {
        const GroundHeights::Index to = {cell[0] + y, cell[1] + x};
        const int64_t distance = y * y + x * x;
        const auto known = added.find(to);
        if ((known == added.end() || distance < known->second.distance) && !levels.contains(to)) {
          Range planes = cells_.at(key_of(cell));
          planes.to_row = static_cast<int8_t>(-y);
          planes.to_column = static_cast<int8_t>(-x);
          added[to] = {distance, planes};
        }
      }
    }
  }
  for (const auto& [cell, source] : added) {
    cells_[key_of(cell)] = source.planes;
  }
}

std::vector<double> GroundPlanes::heights_at(const Eigen::Vector2d& place) const {
  const GroundHeights::Index cell = grid_.index_of(place);
  const auto found = cells_.find(key_of(cell));
  if (found == cells_.end()) {
    return {};
  }
  const Range& range = found->second;
  const Eigen::Vector2d from_middle =
      place - grid_.middle({cell[0] + range.to_row, cell[1] + range.to_column});
  std::vector<double> heights;
  for (uint32_t i = range.first; i < range.first + range.count; ++i) {
    const Plane& plane = planes_[i];
    heights.push_back(static_cast<double>(plane.height) +
                      static_cast<double>(plane.slope_x) * from_middle.x() +
                      static_cast<double>(plane.slope_y) * from_middle.y());
  }
  return heights;
}

std::optional<double> GroundPlanes::height_above(const Eigen::Vector3d& point) const {
  std::optional<double> nearest;
  for (const double height : heights_at(point.head<2>())) {
    const double above = point.z() - height;
    if (!nearest || std::abs(above) < std::abs(*nearest)) {
      nearest = above;
    }
  }
  return nearest;
}

bool GroundPlanes::is_ground(const Eigen::Vector3d& point) const {
  const auto above = height_above(point);
  return above && std::abs(*above) <= kThickness;
}

bool GroundPlanes::is_below(const Eigen::Vector3d& point) const {
  const std::vector<double> heights = heights_at(point.head<2>());
  return !heights.empty() && std::ranges::all_of(heights, [&](double height) {
    return point.z() < height - kThickness;
  });
}

}  // namespace adit
