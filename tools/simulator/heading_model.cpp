// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/heading_model.hpp"

#include <cmath>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/gnss_model.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr double kHeadingCorrelation = 60.0;  // s, as of the fixes' errors
constexpr double kHeadingDriftShare = 0.9;    // of the variance

/// From true north to the world's y axis there, clockwise, rad: the world is a plane that touches
/// the Earth at its origin, so that meridians come together.
double convergence_in_plane(const Eigen::Vector3d& p_world) {
  const Geodetic place = geodetic_of(p_world);
  return (place.longitude - kOriginLongitude) * kDegree *
         repeatable_sin_cos(place.latitude * kDegree).sin;
}

}  // namespace

void require_heading_errors(const HeadingErrors& errors) {
  if (!(errors.sigma >= 0.0 && errors.sigma <= 90.0)) {
    throw UsageError(
        fmt::format("the deviation is {} degrees; must be 0 to 90.", shortest(errors.sigma)));
  }
  if (!(std::abs(errors.offset) <= 180.0)) {
    throw UsageError(
        fmt::format("the offset is {} degrees; must be -180 to 180.", shortest(errors.offset)));
  }
}

HeadingSimulator::HeadingSimulator(const HeadingErrors& errors, int rate,
                                   const SplineTrajectory& trajectory,
                                   const Eigen::Vector3d& p_imu_antenna, uint64_t seed)
    : errors_(errors),
      period_(1000000000 / rate),
      trajectory_(&trajectory),
      p_imu_antenna_(p_imu_antenna),
      seed_(seed),
      drift_(CounterRandom(seed, RandomStream::heading).gaussians(~uint64_t{0} >> 2U).x()) {}

Heading HeadingSimulator::next() {
  const CounterRandom random(seed_, RandomStream::heading);
  const double dt = 1e-9 * static_cast<double>(period_);
  const Eigen::Isometry3d T_world_imu = trajectory_->pose(dt * static_cast<double>(index_));
  const Eigen::Vector3d axis = T_world_imu.linear().col(0);
  const Eigen::Vector2d noise = random.gaussians(static_cast<uint64_t>(index_)).head<2>();
  const double kept = repeatable_exp(-dt / kHeadingCorrelation);
  drift_ = kept * drift_ + std::sqrt(1.0 - kept * kept) * noise.x();
  const double error = errors_.sigma * (std::sqrt(kHeadingDriftShare) * drift_ +
                                        std::sqrt(1.0 - kHeadingDriftShare) * noise.y());
  Heading heading;
  heading.stamp = Nanoseconds(index_ * period_);
  heading.yaw = repeatable_atan2(axis.y(), axis.x()) -
                convergence_in_plane(T_world_imu * p_imu_antenna_) +
                (errors_.offset + error) * kDegree;
  ++index_;
  return heading;
}

}  // namespace adit
