// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/upright_box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace adit {
namespace {

// Directions within a right angle that are tried: about a degree apart.
constexpr int kDirections = 90;

/// A unit vector of rational numbers: no library of mathematics decides its bits.
Eigen::Vector2d direction(int i) {
  const double t = static_cast<double>(i) / kDirections;
  return {(1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)};
}

Eigen::Vector2d left_of(const Eigen::Vector2d& along) {
  return {-along.y(), along.x()};
}

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void extend(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double size() const { return high - low; }
  double middle() const { return 0.5 * (low + high); }
};

}  // namespace

std::array<Eigen::Vector2d, 4> UprightBox::footprint() const {
  const Eigen::Vector2d x = 0.5 * size.x() * along;
  const Eigen::Vector2d y = 0.5 * size.y() * left_of(along);
  const Eigen::Vector2d middle = centre.head<2>();
  return {Eigen::Vector2d(middle - x - y), Eigen::Vector2d(middle + x - y),
          Eigen::Vector2d(middle + x + y), Eigen::Vector2d(middle - x + y)};
}

bool UprightBox::contains(const Eigen::Vector3d& point, double margin) const {
  const Eigen::Vector3d off = point - centre;
  const Eigen::Vector2d flat = off.head<2>();
  return std::abs(flat.dot(along)) <= 0.5 * size.x() + margin &&
         std::abs(flat.dot(left_of(along))) <= 0.5 * size.y() + margin &&
         std::abs(off.z()) <= 0.5 * size.z() + margin;
}

UprightBox upright_box(std::span<const Eigen::Vector3d> points) {
  UprightBox best;
  if (points.empty()) {
    return best;
  }
  Extent height;
  for (const Eigen::Vector3d& point : points) {
    height.extend(point.z());
  }
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kDirections; ++i) {
    const Eigen::Vector2d along = direction(i);
    Extent x;
    Extent y;
    for (const Eigen::Vector3d& point : points) {
      x.extend(point.head<2>().dot(along));
      y.extend(point.head<2>().dot(left_of(along)));
    }
    // A clear gain alone turns the box: of equal directions the first stays.
    if (x.size() * y.size() >= least * (1.0 - 1e-9)) {
      continue;
    }
    least = x.size() * y.size();
    const Eigen::Vector2d middle = x.middle() * along + y.middle() * left_of(along);
    best.centre = {middle.x(), middle.y(), height.middle()};
    best.size = {x.size(), y.size(), height.size()};
    best.along = along;
  }
  if (best.size.y() > best.size.x()) {
    std::swap(best.size.x(), best.size.y());
    best.along = {best.along.y(), -best.along.x()};
  }
  return best;
}

}  // namespace adit
