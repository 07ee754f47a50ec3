// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/spin_axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace adit {
namespace {

constexpr float kNearestDirection = 0.1F;  // m
constexpr size_t kFewestDirections = 1000;
constexpr size_t kAsked = 600;  // returns whose neighbours are looked for
constexpr size_t kFewestSteps = 100;
// Neighbours are looked for so far away: beams of few sensors are farther apart.
constexpr double kCell = 0.02;  // rad
constexpr int kCellsAcross = 128;
static_assert(kCell * (kCellsAcross / 2 - 1) > 1.0);
// Two returns of one beam, as of a sensor that reports two echoes, tell no direction.
constexpr double kSameBeam = 2e-5;  // rad
// A step is along a circle or a meridian within so much: coordinates are rounded to millimetres.
// Steps in any direction are so in 22 of 100 cases.
constexpr double kAlong = 10.0 * 3.14159265358979 / 180.0;  // rad
constexpr size_t kTrials = 100;
constexpr double kLeastSine = 0.2;  // between two directions that tell an axis
constexpr int kRefinements = 3;
constexpr double kMostShare = 0.5;  // of Support::share
// z is the axis unless another one is told twice as well: results of sensors that stand upright do
// not depend on what their noise makes of the axis.
constexpr double kTellsZ = 0.5;

/// From a return to its nearest neighbour, on the unit sphere.
struct Step {
  Eigen::Vector3d at;     ///< unit
  Eigen::Vector3d along;  ///< unit, across `at`
  /// The plane's normal that both and the sensor lie in: across the axis for a step of a meridian.
  Eigen::Vector3d across;
};

int cell_of(double coordinate) {
  return static_cast<int>(std::floor(coordinate / kCell)) + kCellsAcross / 2;
}

uint32_t cell_key(int x, int y, int z) {
  return static_cast<uint32_t>((z * kCellsAcross + y) * kCellsAcross + x);
}

uint32_t cell_key(const Eigen::Vector3d& direction) {
  return cell_key(cell_of(direction.x()), cell_of(direction.y()), cell_of(direction.z()));
}

/// Directions of returns, in the order of their cells.
class Directions {
 public:
  explicit Directions(std::span<const Point> points) {
    for (const Point& point : points) {
      const float range = std::hypot(point.x, point.y, point.z);
      if (std::isfinite(range) && range > kNearestDirection) {
        const Eigen::Vector3d direction =
            Eigen::Vector3d(point.x, point.y, point.z) / static_cast<double>(range);
        all_.emplace_back(cell_key(direction), direction.normalized());
      }
    }
    std::ranges::stable_sort(all_, {}, &Entry::first);
  }

  size_t size() const { return all_.size(); }

  /// From the return at that place to its nearest neighbour; nothing where that is far.
  std::optional<Step> step(size_t place) const {
    const Eigen::Vector3d& at = all_[place].second;
    double nearest = kCell * kCell;
    Eigen::Vector3d along = Eigen::Vector3d::Zero();
    const std::array cells = {cell_of(at.x()), cell_of(at.y()), cell_of(at.z())};
    for (int z = cells[2] - 1; z <= cells[2] + 1; ++z) {
      for (int y = cells[1] - 1; y <= cells[1] + 1; ++y) {
        // Cells along x lie behind each other.
        const auto first =
            std::ranges::lower_bound(all_, cell_key(cells[0] - 1, y, z), {}, &Entry::first);
        const uint32_t last = cell_key(cells[0] + 1, y, z);
        for (auto other = first; other != all_.end() && other->first <= last; ++other) {
          const Eigen::Vector3d way = other->second - at;
          const double squared = way.squaredNorm();
          if (squared < nearest && squared > kSameBeam * kSameBeam) {
            nearest = squared;
            along = way;
          }
        }
      }
    }
    along -= along.dot(at) * at;
    if (!(along.norm() > 0.5 * kSameBeam)) {
      return std::nullopt;
    }
    along.normalize();
    return Step{.at = at, .along = along, .across = at.cross(along)};
  }

 private:
  using Entry = std::pair<uint32_t, Eigen::Vector3d>;
  std::vector<Entry> all_;
};

/// Of the two directions of a step the one that is across the axis, if the step lies along a circle
/// or a meridian about it.
std::optional<Eigen::Vector3d> across_axis(const Step& step, const Eigen::Vector3d& axis) {
  static const double kSine = std::sin(kAlong);
  const double along = std::abs(step.along.dot(axis));
  const double across = std::abs(step.across.dot(axis));
  const double least = std::min(along, across);
  if (!(least < kSine * std::hypot(along, across))) {
    return std::nullopt;
  }
  return along < across ? step.along : step.across;
}

/// How well steps tell an axis.
struct Support {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  /// Of all steps, the share that speaks for this axis and against its neighbours to either side: a
  /// half where all lie about it, all around. 0 where fewer than half of the steps agree.
  double share = 0.0;
  Eigen::Vector3d refined = Eigen::Vector3d::UnitZ();  ///< by least squares of those that agree
};

// Steps along the equator of an axis are steps along meridians of every axis across it: all of
// these are across one direction alone, which tells none of them.
Support support_of(std::span<const Step> steps, const Eigen::Vector3d& axis) {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  size_t agreeing = 0;
  for (const Step& step : steps) {
    if (const auto across = across_axis(step, axis)) {
      squares += *across * across->transpose();
      ++agreeing;
    }
  }
  Support support{.axis = axis};
  if (2 * agreeing < steps.size()) {
    return support;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(squares);
  support.share = eigen.eigenvalues()[1] / static_cast<double>(steps.size());
  support.refined = eigen.eigenvectors().col(0);
  return support;
}

/// The best told of those axes that two steps make, spread evenly over all.
Support best_told(std::span<const Step> steps) {
  Support best;
  for (size_t k = 0; k < kTrials; ++k) {
    const size_t first = k * 7919 % steps.size();
    const Step& a = steps[first];
    const Step& b = steps[(first + 1 + k * 104729 % (steps.size() - 1)) % steps.size()];
    const std::array pairs = {std::pair(a.along, b.along), std::pair(a.across, b.across),
                              std::pair(a.along, b.across)};
    for (const auto& [one, other] : pairs) {
      const Eigen::Vector3d axis = one.cross(other);
      if (axis.norm() < kLeastSine) {
        continue;
      }
      const Support support = support_of(steps, axis.normalized());
      best = support.share > best.share ? support : best;
    }
  }
  return best;
}

}  // namespace

Eigen::Vector3d spin_axis(std::span<const Point> points) {
  const Directions directions(points);
  if (directions.size() < kFewestDirections) {
    return Eigen::Vector3d::UnitZ();
  }
  std::vector<Step> steps;
  const size_t stride = std::max<size_t>(directions.size() / kAsked, 1);
  for (size_t i = 0; i < directions.size(); i += stride) {
    if (const auto step = directions.step(i)) {
      steps.push_back(*step);
    }
  }
  if (steps.size() < kFewestSteps) {
    return Eigen::Vector3d::UnitZ();
  }
  const Support z = support_of(steps, Eigen::Vector3d::UnitZ());
  if (z.share > kTellsZ * kMostShare) {
    return Eigen::Vector3d::UnitZ();
  }
  Support best = best_told(steps);
  for (int i = 0; i < kRefinements && best.share > 0.0; ++i) {
    best = support_of(steps, best.refined);
  }
  return best.share > 0.0 && z.share < kTellsZ * best.share ? best.axis : Eigen::Vector3d::UnitZ();
}

}  // namespace adit
