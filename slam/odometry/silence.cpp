// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/silence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "adit/slam/core/median.hpp"

namespace adit {
namespace {

// A velocity changes by white acceleration and reverts to zero (an Ornstein-Uhlenbeck process): in
// the long run by 1.6 m/s and 1.6 rad/s, a person with a sensor in the hand.
constexpr double kMotionAcceleration = 1.0;  // m/s^2 / sqrt(Hz)
constexpr double kMotionTurning = 1.0;       // rad/s^2 / sqrt(Hz)
constexpr double kVelocityDecay = 5.0;       // s
// Of a sensor that was faster it changes, in the long run, by half of its highest speed: cars stop,
// and drive off.
constexpr double kShareOfSpeed = 0.5;
// Of a turn nothing is known: any angle is as likely, rad.
const double kAnyTurn = std::numbers::pi / std::sqrt(3.0);
constexpr size_t kIntervals = 9;     // whose median is usual
constexpr size_t kSampled = 2048;    // points that show a sweep's range, at the least
constexpr double kReachShare = 0.9;  // of the returns

/// s: a velocity at the beginning carries so long.
double carried(double elapsed) {
  return kVelocityDecay * (1.0 - std::exp(-elapsed / kVelocityDecay));
}

/// s^3: variance of the position for a density of 1.
double spread(double elapsed) {
  const double square = kVelocityDecay * kVelocityDecay;
  const double reverted = 1.0 - std::exp(-2.0 * elapsed / kVelocityDecay);
  return square * (elapsed - 2.0 * carried(elapsed) + 0.5 * kVelocityDecay * reverted);
}

}  // namespace

double chi2_of(const Silence& silence, const Eigen::Isometry3d& T_map_lidar) {
  const Vector6d off = se3_log(silence.T_map_lidar.inverse() * T_map_lidar);
  return off.cwiseQuotient(silence.sigma).squaredNorm();
}

Silence silence_after(const Eigen::Isometry3d& from, const std::optional<Vector6d>& velocity,
                      double fastest, double elapsed) {
  // The variance of the velocity in the long run is half of density times the time it lasts.
  const double by_speed = 2.0 * std::pow(kShareOfSpeed * fastest, 2) / kVelocityDecay;
  const double density = std::max(kMotionAcceleration * kMotionAcceleration, by_speed);
  Vector6d densities;
  densities << Eigen::Vector3d::Constant(density),
      Eigen::Vector3d::Constant(kMotionTurning * kMotionTurning);
  const double unknown = velocity ? 0.0 : 0.5 * kVelocityDecay * std::pow(carried(elapsed), 2);
  Silence silence{.seconds = elapsed};
  silence.sigma = ((spread(elapsed) + unknown) * densities).cwiseSqrt();
  silence.sigma.tail<3>() = silence.sigma.tail<3>().cwiseMin(kAnyTurn);
  const Vector6d way = carried(elapsed) * velocity.value_or(Vector6d::Zero());
  silence.T_map_lidar = orthonormalized(from * se3_exp(way));
  silence.distance = way.head<3>().norm() + kPlanarSigmas * silence.sigma.head<3>().maxCoeff();
  return silence;
}

void SweepRhythm::add(const Sweep& sweep) {
  if (last_ && sweep.stamp > *last_) {
    intervals_.push_back(seconds(sweep.stamp - *last_));
    if (intervals_.size() > kIntervals) {
      intervals_.pop_front();
    }
  }
  last_ = sweep.stamp;
  if (!duration_) {
    const double duration = duration_of(sweep);
    duration_ = duration > 0.0 ? std::optional(duration) : std::nullopt;
  }
}

std::optional<double> SweepRhythm::usual() const {
  return intervals_.empty()
             ? duration_
             : std::optional(median(std::vector(intervals_.begin(), intervals_.end())));
}

double reach_of(std::span<const Point> points) {
  std::vector<float> ranges;
  const size_t stride = points.size() / kSampled | 1U;  // odd: rings come in turns
  for (size_t i = 0; i < points.size(); i += stride) {
    const float range = std::hypot(points[i].x, points[i].y, points[i].z);
    if (std::isfinite(range) && range > 0.0F) {
      ranges.push_back(range);
    }
  }
  if (ranges.empty()) {
    return 0.0;
  }
  const auto far = ranges.begin() + static_cast<std::ptrdiff_t>(
                                        kReachShare * static_cast<double>(ranges.size() - 1));
  std::ranges::nth_element(ranges, far);
  return *far;
}

}  // namespace adit
