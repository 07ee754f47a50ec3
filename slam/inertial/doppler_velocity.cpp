// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/doppler_velocity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/median.hpp"

namespace adit {
namespace {

// So many points determine the velocity to a millimetre a second; fewer than the least do not
// outweigh a moving object.
constexpr std::size_t kMostPoints = 4096;
constexpr std::size_t kFewestPoints = 12;
// m/s. Speeds of points are no better than that (frequency-modulated lidars: 0.03 to 0.1), and
// what they err by together, such as by the laser's drift, may be so much.
constexpr double kPointSigma = 0.05;
constexpr double kCommonSigma = 0.02;
// rad. What directions of all points of a radar err by together: its mounting, which is adjusted to
// half a degree, and its antenna. It turns the velocity.
constexpr double kCommonTurn = 0.01;
// m/s². What the velocity changes by within a sweep, in the sensor's own axes: turns included.
constexpr double kChange = 10.0;
// rad/s. What a vehicle may turn by, where nothing shows it.
constexpr double kTurn = 1.0;
// From all points to those at rest: the weights then change by less than a thousandth.
constexpr int kRounds = 10;
// Samples of four points, so that one without outliers is among them at 999 in 1000 where half of
// the points are outliers; scored by so many points at most.
constexpr int kSamples = 110;
constexpr std::size_t kSampleSize = 4;
constexpr std::size_t kScored = 512;
// Standard deviation of a normal distribution over the median of its absolute values.
constexpr double kSigmaOfMedian = 1.4826;
// Standard deviations beyond which a point is not at rest; and m/s, the pace of somebody who
// strolls, which is more than vibration makes.
constexpr double kMovingSigmas = 4.0;
constexpr double kMovingSpeed = 0.4;

/// Of the velocity at the sweep's middle, of its change a second, and of the turning rate.
using Row = Eigen::Matrix<double, 9, 1>;
using RowMatrix = Eigen::Matrix<double, 9, 9>;

/// A point as the fit sees it.
struct Ray {
  Row row;
  double speed;  ///< m/s, measured
};

/// Nothing where the point has no direction or no speed.
std::optional<Ray> ray_of(const Sweep& sweep, std::size_t i, double middle,
                          std::span<const Eigen::Vector3d> origins) {
  const Point& point = sweep.points[i];
  const std::size_t sensor = origins.empty() || sweep.rings.empty() ? 0 : sweep.rings[i];
  const Eigen::Vector3d origin =
      sensor < origins.size() ? origins[sensor] : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const Eigen::Vector3d p(point.x, point.y, point.z);
  const double range = (p - origin).norm();
  const double speed = sweep.doppler[i];
  const double time = sweep.times.empty() ? middle : static_cast<double>(sweep.times[i]);
  if (p.isZero() || !(range > 0.0) || !std::isfinite(range) || !std::isfinite(speed) ||
      !std::isfinite(time)) {
    return std::nullopt;
  }
  const Eigen::Vector3d towards = (origin - p) / range;
  Ray ray{.row = {}, .speed = speed};
  ray.row << towards, (time - middle) * towards, origin.cross(towards);
  return ray;
}

/// Normal equations with the weights of one round.
struct Normal {
  RowMatrix h = RowMatrix::Zero();
  Row g = Row::Zero();

  Normal() {
    h.diagonal().head<3>().setConstant(1e-6);  // what nothing shows stays at zero
    h.diagonal().segment<3>(3).setConstant(1.0 / (kChange * kChange));
    h.diagonal().tail<3>().setConstant(1.0 / (kTurn * kTurn));
  }
  void add(const Ray& ray, double weight) {
    h += weight * ray.row * ray.row.transpose();
    g += weight * ray.speed * ray.row;
  }
  Row solution() const { return h.ldlt().solve(g); }
};

Normal normal(const std::vector<Ray>& rays, const Row& at, double sigma) {
  Normal sum;
  for (const Ray& ray : rays) {
    const double error = (ray.speed - ray.row.dot(at)) / sigma;
    sum.add(ray, 1.0 / ((1.0 + error * error / (kMovingSigmas * kMovingSigmas)) * sigma * sigma));
  }
  return sum;
}

/// Of all samples the solution that is nearest to most rays.
Row most_agreed(const std::vector<Ray>& rays) {
  const std::size_t stride = std::max<std::size_t>(1, rays.size() / kScored);
  uint64_t state = 0x9e3779b97f4a7c15U;  // Knuth's generator (MMIX): the same for every sweep
  const auto draw = [&] {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::size_t>(state >> 33U) % rays.size();
  };
  Row best = Row::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (int sample = 0; sample < kSamples; ++sample) {
    Normal sum;
    for (std::size_t i = 0; i < kSampleSize; ++i) {
      sum.add(rays[draw()], 1.0 / (kPointSigma * kPointSigma));
    }
    const Row at = sum.solution();
    double cost = 0.0;
    for (std::size_t i = 0; i < rays.size(); i += stride) {
      const double error = (rays[i].speed - rays[i].row.dot(at)) / kMovingSpeed;
      cost += std::min(error * error, 1.0);
    }
    if (cost < least) {
      least = cost;
      best = at;
    }
  }
  return best;
}

double spread(const std::vector<Ray>& rays, const Row& at) {
  std::vector<double> errors;
  for (const Ray& ray : rays) {
    errors.push_back(std::abs(ray.speed - ray.row.dot(at)));
  }
  return std::max(kPointSigma, kSigmaOfMedian * median(std::move(errors)));
}

/// Of [v, w], with what all points err by together.
Matrix6d twist_covariance(const RowMatrix& inverse, const Eigen::Vector3d& velocity,
                          std::span<const Eigen::Vector3d> origins) {
  Matrix6d covariance;
  covariance << inverse.topLeftCorner<3, 3>(), inverse.topRightCorner<3, 3>(),
      inverse.bottomLeftCorner<3, 3>(), inverse.bottomRightCorner<3, 3>();
  Eigen::Matrix3d common = kCommonSigma * kCommonSigma * Eigen::Matrix3d::Identity();
  if (origins.size() < 2) {
    covariance.topLeftCorner<3, 3>() += common;
    return covariance;
  }
  common += kCommonTurn * kCommonTurn * skew(velocity) * skew(velocity).transpose();
  covariance.topLeftCorner<3, 3>() += common;
  double apart = 0.0;
  for (const Eigen::Vector3d& origin : origins) {
    apart = std::max(apart, (origin - origins.front()).norm());
  }
  covariance.bottomRightCorner<3, 3>().diagonal().array() +=
      2.0 * common.diagonal().maxCoeff() / std::max(apart * apart, 0.01);
  return covariance;
}

}  // namespace

std::optional<DopplerFit> fit_doppler(const Sweep& sweep,
                                      std::span<const Eigen::Vector3d> origins) {
  if (sweep.doppler.empty() || sweep.doppler.size() != sweep.points.size()) {
    return std::nullopt;
  }
  const double middle = 0.5 * duration_of(sweep);
  const std::size_t stride = std::max<std::size_t>(1, sweep.points.size() / kMostPoints);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < sweep.points.size(); i += stride) {
    if (const auto ray = ray_of(sweep, i, middle, origins)) {
      rays.push_back(*ray);
    }
  }
  if (rays.size() < kFewestPoints) {
    return std::nullopt;
  }
  Row velocity = most_agreed(rays);
  double sigma = spread(rays, velocity);
  Normal last = normal(rays, velocity, sigma);
  for (int round = 0; round < kRounds; ++round) {
    velocity = last.solution();
    sigma = spread(rays, velocity);
    last = normal(rays, velocity, sigma);
  }
  const double still = std::max(kMovingSpeed, kMovingSigmas * sigma);
  const auto moves = [&](const Ray& ray) {
    return std::abs(ray.speed - ray.row.dot(velocity)) > still;
  };
  const Eigen::Vector3d linear = velocity.head<3>();
  const Matrix6d covariance = twist_covariance(last.h.inverse(), linear, origins);
  if (!covariance.allFinite() || !velocity.allFinite() ||
      Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance).eigenvalues()[0] <= 0.0 ||
      2 * static_cast<std::size_t>(std::ranges::count_if(rays, moves)) > rays.size()) {
    return std::nullopt;
  }
  DopplerFit fit{.velocity = {.stamp = sweep.stamp + nanoseconds(middle),
                              .linear = linear,
                              .covariance = Eigen::Matrix3d(covariance.topLeftCorner<3, 3>())},
                 .moving = {},
                 .used = rays.size()};
  fit.twist.rate << linear, velocity.tail<3>();
  fit.twist.covariance = covariance;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const auto ray = ray_of(sweep, i, middle, origins);
    if (ray && moves(*ray)) {
      fit.moving.push_back(i);
    }
  }
  return fit;
}

}  // namespace adit
