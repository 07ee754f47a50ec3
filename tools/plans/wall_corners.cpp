// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/wall_corners.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace adit {
namespace {

using Eigen::Vector2d;

// Lines that cross at less than 30 degrees cross where noise puts it.
constexpr double kLeastSine = 0.5;
// m, that a corner takes off a wall: by two cells a line is grown too long at most.
constexpr double kMostCut = 2.0 * SliceCells::kEdge;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Where the line of `wall` crosses that of `other`, and how far from the other's nearer end if it
/// is beyond it.
struct Crossing {
  Vector2d at = Vector2d::Zero();
  double beyond = 0.0;  ///< m; 0: it is on the other wall
};
std::optional<Crossing> crossing(const WallSegment& wall, const WallSegment& other) {
  const Vector2d along = wall.to - wall.from;
  const Vector2d across = other.to - other.from;
  const double sine = cross(along, across);
  if (std::abs(sine) < kLeastSine * along.norm() * across.norm()) {
    return std::nullopt;
  }
  const double share = cross(other.from - wall.from, across) / sine;
  const double on_other = cross(other.from - wall.from, along) / sine;
  const double outside = on_other < 0.0 ? -on_other : on_other > 1.0 ? on_other - 1.0 : 0.0;
  return Crossing{.at = wall.from + share * along, .beyond = outside * across.norm()};
}

/// The nearest crossing to the end `end` of a wall, otherwise that end.
Vector2d corner_of(const std::vector<WallSegment>& walls, const WallIndex& index, std::size_t wall,
                   const Vector2d& end, double reach) {
  const Vector2d outwards =
      (2.0 * end - walls[wall].from - walls[wall].to).normalized();  // from the middle
  Vector2d corner = end;
  double nearest = reach;
  for (const std::size_t other : index.near(end)) {
    const auto met = other == wall ? std::nullopt : crossing(walls[wall], walls[other]);
    if (met && met->beyond <= reach && (met->at - end).norm() <= nearest &&
        outwards.dot(met->at - end) >= -kMostCut) {
      nearest = (met->at - end).norm();
      corner = met->at;
    }
  }
  return corner;
}

}  // namespace

WallIndex::WallIndex(const std::vector<WallSegment>& walls, double size) : size_(size) {
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vector2d way = walls[i].to - walls[i].from;
    const auto steps = std::max(int64_t{1}, static_cast<int64_t>(std::ceil(way.norm() / size)));
    for (int64_t step = 0; step <= steps; ++step) {
      const double share = static_cast<double>(step) / static_cast<double>(steps);
      squares_[square(walls[i].from + share * way)].insert(i);
    }
  }
}

std::set<std::size_t> WallIndex::near(const Vector2d& place) const {
  std::set<std::size_t> found;
  const auto [y, x] = square(place);
  for (int64_t dy = -2; dy <= 2; ++dy) {
    for (int64_t dx = -2; dx <= 2; ++dx) {
      if (const auto at = squares_.find({y + dy, x + dx}); at != squares_.end()) {
        found.insert(at->second.begin(), at->second.end());
      }
    }
  }
  return found;
}

std::pair<int64_t, int64_t> WallIndex::square(const Vector2d& place) const {
  return {static_cast<int64_t>(std::floor(place.y() / size_)),
          static_cast<int64_t>(std::floor(place.x() / size_))};
}

double distance(const WallSegment& wall, const Vector2d& place) {
  const Vector2d way = wall.to - wall.from;
  const double square = way.squaredNorm();
  const double share =
      square > 0.0 ? std::clamp(way.dot(place - wall.from) / square, 0.0, 1.0) : 0.0;
  return (wall.from + share * way - place).norm();
}

void join_corners(std::vector<WallSegment>& walls, double reach) {
  const std::vector<WallSegment> found = walls;
  const WallIndex index(found, reach);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    walls[i].from = corner_of(found, index, i, found[i].from, reach);
    walls[i].to = corner_of(found, index, i, found[i].to, reach);
  }
}

}  // namespace adit
