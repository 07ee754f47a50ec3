// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/high_rate_stream.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kLongestAhead = std::chrono::seconds(1);

}  // namespace

LidarMotion lidar_motion(const HighRateState& state, const Eigen::Isometry3d& T_body_lidar) {
  const Eigen::Matrix3d& R_map_body = state.nav.T_map_body.linear();
  const Eigen::Vector3d& lever = T_body_lidar.translation();
  const Eigen::Vector3d swing = state.angular_velocity.cross(lever);  // m/s, body axes
  LidarMotion motion;
  motion.stamp = state.nav.stamp;
  motion.T_map_lidar = state.nav.T_map_body * T_body_lidar;
  motion.v_map_lidar = state.nav.v_map_body + R_map_body * swing;
  motion.angular_velocity = T_body_lidar.linear().transpose() * state.angular_velocity;
  Eigen::Matrix<double, 9, kStateSize> by_state = Eigen::Matrix<double, 9, kStateSize>::Zero();
  by_state.block<6, 6>(0, kPositionAt) = adjoint(T_body_lidar.inverse());
  by_state.block<3, 3>(6, kRotationAt) = -R_map_body * skew(swing);
  by_state.block<3, 3>(6, kVelocityAt).setIdentity();
  by_state.block<3, 3>(6, kGyroBiasAt) = R_map_body * skew(lever);
  motion.covariance = by_state * state.covariance * by_state.transpose();
  return motion;
}

HighRateStream::HighRateStream(const ImuConfig& config, double smoothing)
    : max_gap_(config.max_gap), odometry_(imu_noise(config), smoothing) {}

void HighRateStream::stop() {
  odometry_.stop();
  estimate_.reset();
}

std::optional<LidarMotion> HighRateStream::add(const ImuSample& reading, ImuArrival arrival) {
  ImuSample sample = reading;
  sample.stamp -= clock_offset_;
  sample.linear_acceleration *= accel_scale_;
  if (arrival == ImuArrival::restarted) {
    stop();
    newest_.reset();
  } else if (arrival != ImuArrival::appended) {
    return std::nullopt;
  }
  if (!newest_ || seconds(sample.stamp - *newest_) > max_gap_) {
    stop();
    whole_since_ = sample.stamp;
  }
  newest_ = sample.stamp;
  const std::optional<HighRateState> state = odometry_.add(sample);
  if (!state || sample.stamp > *estimate_ + kLongestAhead || (given_ && sample.stamp <= *given_)) {
    return std::nullopt;
  }
  given_ = sample.stamp;
  return lidar_motion(*state, T_body_lidar_);
}

void HighRateStream::update(const InertialReport& report) {
  const Nanoseconds clock_offset = nanoseconds(report.clock_offset);
  const bool read_otherwise = report.accel_scale != accel_scale_ || clock_offset != clock_offset_;
  if (read_otherwise || (estimate_ && !report.nav)) {
    stop();
  }
  if (read_otherwise) {
    newest_.reset();  // what was kept has another unit or clock: the next reading begins anew
    whole_since_ = Nanoseconds::max();
  }
  accel_scale_ = report.accel_scale;
  clock_offset_ = clock_offset;
  T_body_lidar_ = report.T_body_lidar;
  if (report.nav && report.nav->stamp >= whole_since_) {
    odometry_.correct({.state = *report.nav, .covariance = report.nav_covariance});
    estimate_ = report.nav->stamp;
  }
}

}  // namespace adit
