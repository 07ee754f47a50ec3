// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/doppler_velocity.hpp"

#include <algorithm>
#include <cmath>
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
constexpr std::size_t kFewestPoints = 20;
// m/s. Speeds of points are no better than that (frequency-modulated lidars: 0.03 to 0.1), and
// what they err by together, such as by the laser's drift, may be so much.
constexpr double kPointSigma = 0.05;
constexpr double kCommonSigma = 0.02;
// m/s². What the velocity changes by within a sweep, in the sensor's own axes: turns included.
constexpr double kChange = 10.0;
// From all points to those at rest: the weights then change by less than a thousandth.
constexpr int kRounds = 10;
// Standard deviation of a normal distribution over the median of its absolute values.
constexpr double kSigmaOfMedian = 1.4826;
// Standard deviations beyond which a point is not at rest; and m/s, the pace of somebody who
// strolls, which is more than vibration makes.
constexpr double kMovingSigmas = 4.0;
constexpr double kMovingSpeed = 0.4;

/// A point as the fit sees it.
struct Ray {
  Vector6d row;  ///< of the velocity at the sweep's middle, and of its change a second
  double speed;  ///< m/s, measured
};

/// Nothing where the point has no direction or no speed.
std::optional<Ray> ray_of(const Sweep& sweep, std::size_t i, double middle) {
  const Point& point = sweep.points[i];
  const Eigen::Vector3d p(point.x, point.y, point.z);
  const double range = p.norm();
  const double speed = sweep.doppler[i];
  const double time = sweep.times.empty() ? middle : static_cast<double>(sweep.times[i]);
  if (!(range > 0.0) || !std::isfinite(range) || !std::isfinite(speed) || !std::isfinite(time)) {
    return std::nullopt;
  }
  const Eigen::Vector3d towards = -p / range;
  Ray ray{.row = {}, .speed = speed};
  ray.row << towards, (time - middle) * towards;
  return ray;
}

/// Normal equations with the weights of one round.
struct Normal {
  Matrix6d h;
  Vector6d g;
};

Normal normal(const std::vector<Ray>& rays, const Vector6d& at, double sigma) {
  Normal sum{.h = Matrix6d::Zero(), .g = Vector6d::Zero()};
  sum.h.bottomRightCorner<3, 3>().diagonal().setConstant(1.0 / (kChange * kChange));
  sum.h.topLeftCorner<3, 3>().diagonal().setConstant(1e-6);  // what nothing shows stays at zero
  for (const Ray& ray : rays) {
    const double error = (ray.speed - ray.row.dot(at)) / sigma;
    const double weight =
        1.0 / ((1.0 + error * error / (kMovingSigmas * kMovingSigmas)) * sigma * sigma);
    sum.h += weight * ray.row * ray.row.transpose();
    sum.g += weight * ray.speed * ray.row;
  }
  return sum;
}

}  // namespace

std::optional<DopplerFit> fit_doppler(const Sweep& sweep) {
  if (sweep.doppler.empty() || sweep.doppler.size() != sweep.points.size()) {
    return std::nullopt;
  }
  const double middle = 0.5 * duration_of(sweep);
  const std::size_t stride = std::max<std::size_t>(1, sweep.points.size() / kMostPoints);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < sweep.points.size(); i += stride) {
    if (const auto ray = ray_of(sweep, i, middle)) {
      rays.push_back(*ray);
    }
  }
  if (rays.size() < kFewestPoints) {
    return std::nullopt;
  }
  const auto spread = [&](const Vector6d& at) {
    std::vector<double> errors;
    for (const Ray& ray : rays) {
      errors.push_back(std::abs(ray.speed - ray.row.dot(at)));
    }
    return std::max(kPointSigma, kSigmaOfMedian * median(std::move(errors)));
  };
  Vector6d velocity = Vector6d::Zero();
  Normal last = normal(rays, velocity, spread(velocity));
  double sigma = kPointSigma;
  for (int round = 0; round < kRounds; ++round) {
    velocity = last.h.ldlt().solve(last.g);
    sigma = spread(velocity);
    last = normal(rays, velocity, sigma);
  }
  DopplerFit fit{
      .velocity = {.stamp = sweep.stamp + nanoseconds(middle), .linear = velocity.head<3>()},
      .moving = {},
      .used = rays.size()};
  const Eigen::Matrix3d covariance = Matrix6d(last.h.inverse()).topLeftCorner<3, 3>() +
                                     kCommonSigma * kCommonSigma * Eigen::Matrix3d::Identity();
  if (!covariance.allFinite() || !velocity.allFinite() ||
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[0] <= 0.0) {
    return std::nullopt;
  }
  fit.velocity.covariance = covariance;
  const double still = std::max(kMovingSpeed, kMovingSigmas * sigma);
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const auto ray = ray_of(sweep, i, middle);
    if (ray && std::abs(ray->speed - ray->row.dot(velocity)) > still) {
      fit.moving.push_back(i);
    }
  }
  return fit;
}

}  // namespace adit
