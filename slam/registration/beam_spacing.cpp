// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/beam_spacing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "adit/slam/core/config.hpp"
#include "adit/slam/registration/spin_axis.hpp"

namespace adit {
namespace {

constexpr size_t kFewestReturns = 1000;
constexpr int kSectors = 360;
constexpr double kNarrowest = 0.002;    // rad
constexpr double kWidest = 0.2;         // rad
constexpr float kNearestReturn = 0.1F;  // m
constexpr double kVoxelsToFar =
    60.0;  // as many voxels lie between the sensor and nine in ten points
constexpr double kSmallestVoxel = 0.05;  // m

/// Half of the sum of all gaps is in gaps up to this one. 0: there are none.
double median_by_length(std::vector<double> gaps) {
  std::ranges::sort(gaps);
  double sum = 0.0;
  for (const double gap : gaps) {
    sum += gap;
  }
  double so_far = 0.0;
  for (const double gap : gaps) {
    so_far += gap;
    if (so_far >= 0.5 * sum) {
      return gap;
    }
  }
  return 0.0;
}

/// About z.
std::optional<double> spacing_about_z(std::span<const Point> points) {
  std::array<std::vector<double>, kSectors> elevations;
  size_t returns = 0;
  for (const Point& p : points) {
    const double across = std::hypot(p.x, p.y);
    if (!std::isfinite(across) || !std::isfinite(p.z) || across < 0.1) {
      continue;
    }
    const double turn = (std::atan2(p.y, p.x) / std::numbers::pi + 1.0) * 0.5;
    const int sector = std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1);
    elevations[static_cast<size_t>(sector)].push_back(std::atan2(static_cast<double>(p.z), across));
    ++returns;
  }
  if (returns < kFewestReturns) {
    return std::nullopt;
  }
  std::vector<double> gaps;
  for (std::vector<double>& sector : elevations) {
    std::ranges::sort(sector);
    for (size_t i = 1; i < sector.size(); ++i) {
      gaps.push_back(sector[i] - sector[i - 1]);
    }
  }
  return std::clamp(median_by_length(std::move(gaps)), kNarrowest, kWidest);
}

}  // namespace

std::optional<double> measured_beam_spacing(std::span<const Point> points) {
  const Eigen::Vector3d axis = spin_axis(points);
  if (axis == Eigen::Vector3d::UnitZ()) {
    return spacing_about_z(points);
  }
  const Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(axis, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  std::vector<Point> turned(points.begin(), points.end());
  for (Point& p : turned) {
    const Eigen::Vector3f q = (R * Eigen::Vector3d(p.x, p.y, p.z)).cast<float>();
    p = {.x = q.x(), .y = q.y(), .z = q.z(), .intensity = p.intensity};
  }
  return spacing_about_z(turned);
}

std::optional<double> measured_voxel_size(std::span<const Point> points) {
  std::vector<float> ranges;
  for (const Point& p : points) {
    const float range = std::hypot(p.x, p.y, p.z);
    if (std::isfinite(range) && range > kNearestReturn) {
      ranges.push_back(range);
    }
  }
  if (ranges.size() < kFewestReturns) {
    return std::nullopt;
  }
  const auto far = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() * 9 / 10);
  std::ranges::nth_element(ranges, far);
  return std::clamp(static_cast<double>(*far) / kVoxelsToFar, kSmallestVoxel, kUsualInput);
}

}  // namespace adit
