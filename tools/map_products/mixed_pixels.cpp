// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/mixed_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include <Eigen/Core>

#include "adit/tools/clouds/returns.hpp"

namespace adit {
namespace {

constexpr std::size_t kSide = 4;  // returns on either side
// A line through the inverse ranges at 1 .. 4 steps, at 0: weights of the four, and the variance of
// that relative to one range's.
constexpr std::array<double, kSide> kWeights = {1.0, 0.5, 0.0, -0.5};
constexpr double kLineVariance = 1.5;
constexpr double kPulse = 0.9;        // m, of 6 ns there and back
constexpr double kBeyondNoise = 3.0;  // standard deviations
constexpr double kSmooth = 4.0;       // the same, of a side's own returns from its line
constexpr double kStep = 1.5;         // times the median angle between returns: none is missing

struct RingReturn {
  std::size_t number = 0;  ///< among the sweep's returns
  Eigen::Vector3d direction;
  double inverse = 0.0;  ///< 1/m
};
using RingReturns = std::vector<RingReturn>;

std::map<uint16_t, RingReturns> returns_by_ring(const Sweep& sweep) {
  std::map<uint16_t, RingReturns> rings;
  std::size_t number = 0;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const Point& point = sweep.points[i];
    if (is_return(point)) {
      const Eigen::Vector3d p(point.x, point.y, point.z);
      rings[sweep.rings[i]].push_back(
          {.number = number++, .direction = p.normalized(), .inverse = 1.0 / p.norm()});
    }
  }
  return rings;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

struct SweepScale {
  double step = 0.0;   ///< rad, between neighbours
  double noise = 0.0;  ///< m, standard deviation of a range
};

SweepScale scale_of(const std::map<uint16_t, RingReturns>& rings) {
  constexpr double kMedianOfNormal = 0.6745;  // of the absolute value, in standard deviations
  std::vector<double> steps;
  std::vector<double> bends;
  for (const auto& [ring, returns] : rings) {
    for (std::size_t i = 2; i < returns.size(); ++i) {
      steps.push_back((returns[i].direction - returns[i - 1].direction).norm());
      const double inverse = returns[i - 1].inverse;
      bends.push_back(std::abs(returns[i].inverse - 2.0 * inverse + returns[i - 2].inverse) /
                      (inverse * inverse));
    }
  }
  if (steps.empty()) {
    return {};
  }
  return {.step = median(steps), .noise = median(bends) / (kMedianOfNormal * std::sqrt(6.0))};
}

/// Range of the surface that the returns on one side are of, at return `i`; 0 where they are of
/// none, or one is missing.
double predicted(const RingReturns& returns, std::size_t i, int side, const SweepScale& scale) {
  std::array<double, kSide> inverse{};
  double at_return = 0.0;
  double slope = 0.0;
  double mean = 0.0;
  for (std::size_t k = 0; k < kSide; ++k) {
    const auto steps = static_cast<std::ptrdiff_t>(k + 1);
    const RingReturn& one =
        returns[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + side * steps)];
    const RingReturn& before =
        returns[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + side * (steps - 1))];
    if ((one.direction - before.direction).norm() > kStep * scale.step) {
      return 0.0;
    }
    inverse[k] = one.inverse;
    at_return += kWeights[k] * one.inverse;
    mean += one.inverse / kSide;
  }
  slope = (mean - at_return) / 2.5;
  for (std::size_t k = 0; k < kSide; ++k) {
    const double line = at_return + slope * static_cast<double>(k + 1);
    if (std::abs(inverse[k] - line) > kSmooth * scale.noise * inverse[k] * inverse[k]) {
      return 0.0;
    }
  }
  return at_return > 0.0 ? 1.0 / at_return : 0.0;
}

}  // namespace

std::vector<bool> mixed_pixels(const Sweep& sweep) {
  const auto count = static_cast<std::size_t>(
      std::ranges::count_if(sweep.points, [](const Point& point) { return is_return(point); }));
  std::vector<bool> mixed(count, false);
  if (sweep.rings.size() != sweep.points.size()) {
    return mixed;
  }
  const std::map<uint16_t, RingReturns> rings = returns_by_ring(sweep);
  const SweepScale scale = scale_of(rings);
  const double least = kBeyondNoise * scale.noise * std::sqrt(1.0 + kLineVariance);
  for (const auto& [ring, returns] : rings) {
    for (std::size_t i = kSide; i + kSide < returns.size(); ++i) {
      const double range = 1.0 / returns[i].inverse;
      const double one = predicted(returns, i, -1, scale);
      const double other = one > 0.0 ? predicted(returns, i, 1, scale) : 0.0;
      mixed[returns[i].number] = other > 0.0 && std::abs(one - other) < kPulse &&
                                 std::min(one, other) + least < range &&
                                 range + least < std::max(one, other);
    }
  }
  return mixed;
}

}  // namespace adit
