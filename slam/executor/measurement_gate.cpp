// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/executor/measurement_gate.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>

#include "adit/slam/core/farthest_point_time.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"

namespace adit {
namespace {

/// A variance in each direction, none of them negative. Zeros are variances that nobody filled in.
bool is_covariance(const Eigen::Matrix2d& level, double height) {
  return level.allFinite() && level.diagonal().minCoeff() >= 0.0 && !(height < 0.0);
}

bool is_covariance_of(const Eigen::Matrix3d& of_velocity) {
  return of_velocity.allFinite() && of_velocity.isApprox(of_velocity.transpose(), 1e-6) &&
         of_velocity.llt().info() == Eigen::Success;
}

bool has_finite_height(const Eigen::Matrix3d& covariance) {
  return covariance.row(2).allFinite() && covariance.col(2).allFinite();
}

}  // namespace

std::optional<Measurement> MeasurementGate::pass(Measurement measurement) {
  if (auto* sweep = std::get_if<Sweep>(&measurement)) {
    mend(*sweep);
  } else if (auto* fix = std::get_if<GnssFix>(&measurement); fix != nullptr && !mend(*fix)) {
    return std::nullopt;
  } else if (auto* velocity = std::get_if<BodyVelocity>(&measurement);
             velocity != nullptr && !mend(*velocity)) {
    return std::nullopt;
  } else if (auto* heading = std::get_if<Heading>(&measurement);
             heading != nullptr && !mend(*heading)) {
    return std::nullopt;
  }
  return measurement;
}

bool MeasurementGate::pass(const StaticTransform& transform) {
  const bool finite = transform.T_parent_child.matrix().allFinite();
  faults_.transforms += finite ? 0U : 1U;
  return finite;
}

void MeasurementGate::mend(Sweep& sweep) {
  for (Point& point : sweep.points) {
    if (!std::isfinite(point.intensity)) {
      point.intensity = 0.0F;
      ++faults_.intensities;
    }
  }
  for (float& time : sweep.times) {
    if (!(std::abs(time) <= kFarthestPointTime)) {
      time = std::numeric_limits<float>::quiet_NaN();
      ++faults_.times;
    }
  }
}

// False: it has no position. A receiver without one may fill in whatever it likes.
bool MeasurementGate::mend(GnssFix& fix) {
  ++faults_.fixes;
  if (fix.kind == GnssFixKind::none) {
    return true;
  }
  if (!std::isfinite(fix.latitude) || !std::isfinite(fix.longitude)) {
    ++faults_.fixes_left_out;
    return false;
  }
  bool measured = std::isfinite(fix.altitude);
  if (fix.covariance) {
    const Eigen::Matrix3d& given = *fix.covariance;
    if (!is_covariance(given.topLeftCorner<2, 2>(), given(2, 2))) {
      fix.covariance.reset();
      ++faults_.fixes_without_covariance;
    } else {
      measured = measured && has_finite_height(given);
    }
  }
  if (measured) {
    last_altitude_ = fix.altitude;
  } else {
    fix.altitude = std::isfinite(fix.altitude) ? fix.altitude : last_altitude_;
    fix.covariance = without_height(fix.covariance.value_or(Eigen::Matrix3d::Zero()));
    ++faults_.fixes_without_height;
  }
  return true;
}

// False: it says nothing. Zeros are variances that nobody filled in.
bool MeasurementGate::mend(BodyVelocity& velocity) {
  ++faults_.velocities;
  const auto measured = (velocity.linear.array() == velocity.linear.array()).eval();
  if (!measured.any() || velocity.linear.array().isInf().any()) {
    ++faults_.velocities_left_out;
    return false;
  }
  if (velocity.covariance && !is_covariance_of(*velocity.covariance)) {
    velocity.covariance.reset();
    ++faults_.velocities_without_covariance;
  }
  return true;
}

// False: it says nothing.
bool MeasurementGate::mend(Heading& heading) {
  ++faults_.headings;
  if (!std::isfinite(heading.yaw)) {
    ++faults_.headings_left_out;
    return false;
  }
  heading.yaw = std::remainder(heading.yaw, 2.0 * std::numbers::pi);
  if (heading.sigma && !(std::isfinite(*heading.sigma) && *heading.sigma > 0.0)) {
    heading.sigma.reset();
    ++faults_.headings_without_sigma;
  }
  return true;
}

}  // namespace adit
