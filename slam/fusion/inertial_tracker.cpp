// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/inertial_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace adit {
namespace {

using std::chrono::milliseconds;

// Errors of alignments, as measured (docs/theory/inertial.md, section 9): all of them, and what is
// new with each sweep. The rest stays for some sweeps, as surfaces are cut into the same cells.
constexpr CovarianceModel kAlignmentModel{.kappa = 0.3,
                                          .area = 0.016,
                                          .sigma_translation = 0.002,
                                          .sigma_rotation = 0.0003,
                                          .sigma_unknown_translation = 0.1,
                                          .sigma_unknown_rotation = 0.02};
// Surfaces larger than usual do not count against them: in open fields, where they are, graphs that
// believed alignments that much less went astray on readings alone.
constexpr CovarianceModel kWhiteModel{.kappa = 0.3,
                                      .area = 0.016,
                                      .most_sparse = 1.0,
                                      .sigma_translation = 0.002,
                                      .sigma_rotation = 0.0003};

// chi squared that 99.9 % stay below, by degrees of freedom.
constexpr std::array kChiSquared999 = {0.0, 10.83, 13.82, 16.27, 18.47, 20.52, 22.46};
// Alignments err more than their covariances say: by three times in woods.
constexpr double kBeyondBelief = 10.0;
constexpr int kLongFusion = 100;       // sweeps
constexpr double kScaleError = 0.005;  // of readings: scale, axes that are not square
// After a check that failed the sweeps are to tell what is wrong, without the sensor: for so many.
constexpr int kUnexplained = 50;
// Readings stand for this long after the last one; then velocities stay as they were.
constexpr Nanoseconds kHeld = milliseconds(20);
// What the sign of an accelerometer is believed after, which started at rest.
constexpr double kFarFromRest = 2.0;  // m
// What a prediction must be better than to be aligned from without a search.
constexpr double kTrustedPosition = 0.25;  // m
constexpr double kTrustedRotation = 0.05;  // rad

bool holds_rotation(const RegistrationResult& alignment) {
  return std::ranges::none_of(alignment.rotation, [](const ObservedDirection& direction) {
    return direction.localizability == Localizability::none && !direction.axis.isZero();
  });
}

InertialCause cause_of(const CoverageFault& fault) {
  return std::visit([](const auto& one) { return InertialCause(one); }, fault);
}

/// Of a lidar pose, from that of the body's.
Matrix6d lidar_covariance(const StateMatrix& covariance, const Eigen::Isometry3d& T_body_lidar) {
  const Matrix6d to_lidar = adjoint(T_body_lidar.inverse());
  return to_lidar * covariance.topLeftCorner<6, 6>() * to_lidar.transpose();
}

/// Standard deviations of a lidar pose.
Vector6d lidar_sigma(const StateMatrix& covariance, const Eigen::Isometry3d& T_body_lidar) {
  const Matrix6d of_lidar = lidar_covariance(covariance, T_body_lidar);
  Vector6d floor;
  floor << 0.005, 0.005, 0.005, 0.001, 0.001, 0.001;
  return (of_lidar.diagonal().cwiseMax(0.0) + floor.cwiseAbs2()).cwiseSqrt();
}

}  // namespace

std::string_view to_string(InertialState state) {
  switch (state) {
    case InertialState::absent:
      return "absent";
    case InertialState::starting:
      return "starting";
    case InertialState::fused:
      return "fused";
    case InertialState::lost:
      return "lost";
    case InertialState::refused:
      return "refused";
  }
  return "unknown";
}

ImuNoise imu_noise(const ImuConfig& config) {
  ImuNoise noise = imu_preset(config.sensor, config.noise_scale)
                       .value_or(ImuNoise{.gyro = config.gyro_noise,
                                          .accel = config.accel_noise,
                                          .gyro_walk = config.gyro_walk,
                                          .accel_walk = config.accel_walk});
  noise.scale = kScaleError;
  return noise;
}

InertialTracker::InertialTracker(const ImuConfig& config, double configured_offset)
    : config_(config),
      noise_(imu_noise(config)),
      T_body_lidar_(config.T_imu_lidar ? pose_of(*config.T_imu_lidar)
                                       : Eigen::Isometry3d::Identity()),
      gate_({.rate = config.max_rate, .acceleration = config.max_acceleration}),
      configured_offset_(configured_offset) {}

std::vector<TakenReading> InertialTracker::add(const ImuSample& sample) {
  std::vector<TakenReading> taken;
  for (const GatedReading& known : gate_.pass(sample)) {
    taken.push_back({known.sample, known.dropped ? *known.dropped : take(known.sample)});
  }
  return taken;
}

ImuArrival InertialTracker::take(const ImuSample& sample) {
  ImuSample corrected = sample;
  corrected.stamp -= std::chrono::round<Nanoseconds>(std::chrono::duration<double>(clock_offset_));
  const ImuArrival arrival = buffer_.push(corrected);
  if (arrival == ImuArrival::restarted) {
    saturation_ = {};
    stuck_ = {};
  }
  if (arrival == ImuArrival::appended || arrival == ImuArrival::restarted) {
    monitor_.add(sample);
    saturation_.add(corrected);
    stuck_.add(corrected);
  }
  if (arrival == ImuArrival::appended && state_ == InertialState::absent && config_.use) {
    state_ = InertialState::starting;
  }
  return arrival;
}

std::optional<Eigen::Matrix3d> InertialTracker::level_lidar(Nanoseconds begin,
                                                            Nanoseconds end) const {
  const ImuInterval interval = buffer_.between(begin, end);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : interval.samples) {
    sum += sample.linear_acceleration;
  }
  if (state_ == InertialState::absent || complaint(interval) || !(sum.norm() > 0.0)) {
    return std::nullopt;
  }
  return level_attitude(T_body_lidar_.linear().transpose() * sum);
}

std::vector<ImuSample> InertialTracker::scaled(std::vector<ImuSample> samples) const {
  return accel_scale_ == 1.0 ? std::move(samples) : with_accel_scale(samples, accel_scale_);
}

std::optional<InertialPrediction> InertialTracker::predict(Nanoseconds stamp, double duration) {
  pending_.reset();
  timed_ = duration > 0.0;
  if (state_ != InertialState::fused || stamp <= graph_->latest().stamp) {
    return std::nullopt;
  }
  const ImuInterval interval = buffer_.between(graph_->latest().stamp, stamp);
  if (const auto wrong = complaint(interval)) {
    leave(InertialState::lost, cause_of(*wrong));
    after_gap_ = true;
    return std::nullopt;
  }
  if (const auto stuck = stuck_.stuck()) {
    leave(InertialState::lost, *stuck);
    return std::nullopt;
  }
  const Nanoseconds last = graph_->latest().stamp;
  if (!saturation_.between(last - kToldAgain, last)) {
    const std::optional<Saturation> found = saturation_.between(last, stamp);
    event_ = found ? std::optional(InertialEvent{.cause = *found}) : std::nullopt;
  }
  const double silence = interval.longest_silence();
  pending_ = Pending{.readings = scaled(interval.samples),
                     .prediction = {},
                     .gap = silence > kReadingGap ? silence : 0.0};
  pending_->prediction = graph_->predict(pending_->readings);
  const StateEstimate& predicted = pending_->prediction;
  if (const auto wrong = impossible_motion(predicted)) {
    lose(*wrong);
    return std::nullopt;
  }

  InertialPrediction result;
  result.lidar.T_map_lidar = T_map_lidar(predicted.state);
  result.lidar.sigma = lidar_sigma(predicted.covariance, T_body_lidar_);
  result.lidar.trusted = result.lidar.sigma.head<3>().maxCoeff() < kTrustedPosition &&
                         result.lidar.sigma.tail<3>().maxCoeff() < kTrustedRotation;
  const Nanoseconds end =
      stamp + std::chrono::round<Nanoseconds>(std::chrono::duration<double>(duration));
  const ImuInterval within = buffer_.between(stamp, std::min(end, buffer_.back().stamp + kHeld));
  if (!within.samples.empty() && within.longest_gap <= config_.max_gap) {
    result.motion =
        inertial_motion(predicted.state, scaled(within.samples), T_body_lidar_, 0.0, duration);
  }
  return result;
}

InertialReport InertialTracker::update(const StampedPose& T_map_lidar,
                                       const RegistrationResult* alignment,
                                       const Eigen::Isometry3d& steady,
                                       const SweepMotion* deskewed) {
  InertialReport report;
  unexplained_ = std::max(0, unexplained_ - 1);
  if (alignment != nullptr) {
    report.lidar_covariance = covariance(*alignment, kAlignmentModel);
  }
  if (pending_) {
    fuse(alignment, steady, report);
  } else if (state_ == InertialState::starting || state_ == InertialState::lost) {
    collect(T_map_lidar, alignment != nullptr);
    try_start();
  }
  try_out(report);
  // Turns that no match holds are the prediction's own.
  if (alignment != nullptr && holds_rotation(*alignment)) {
    watch({T_map_lidar.stamp, alignment->T_target_source}, deskewed);
  } else {
    monitor_.broken();
  }
  if (state_ != InertialState::fused) {
    report.nav.reset();
  }
  const Nanoseconds oldest = poses_.empty() ? T_map_lidar.stamp : poses_.front().stamp;
  buffer_.forget_before(oldest - milliseconds(100));
  saturation_.forget_before(oldest - 2 * kToldAgain);
  report.state = state_;
  report.event = std::exchange(event_, std::nullopt);
  report.hindrance = hindrance_;
  report.accel_scale = accel_scale_;
  report.T_body_lidar = T_body_lidar_;
  report.clock_offset = clock_offset_;
  report.comparison = comparison_;
  report.gravity_map = last_fused_ ? last_fused_->gravity_map : Eigen::Vector3d::Zero();
  return report;
}

void InertialTracker::fuse(const RegistrationResult* alignment, const Eigen::Isometry3d& steady,
                           InertialReport& report) {
  const StateEstimate& prediction = pending_->prediction;
  const double elapsed = seconds(prediction.state.stamp - graph_->latest().stamp);
  alone_since_ = alignment != nullptr ? 0.0 : alone_since_ + elapsed;
  std::optional<PoseMeasurement> measurement;
  if (alignment != nullptr) {
    measurement = measured_pose(*alignment, kWhiteModel, T_body_lidar_);
    report.innovation = innovation(prediction, *measurement);
    const auto degrees = static_cast<size_t>(measurement->known_directions);
    report.innovation_gate = kBeyondBelief * kChiSquared999[degrees];
    surprises_ = report.innovation.nis > report.innovation_gate ? surprises_ + 1 : 0;
    const Eigen::Isometry3d& found = alignment->T_target_source;
    const Eigen::Isometry3d inertial_off = found.inverse() * T_map_lidar(prediction.state);
    const Eigen::Isometry3d steady_off = found.inverse() * steady;
    report.compared = true;
    report.better_turn =
        rotation_angle(inertial_off.linear()) < rotation_angle(steady_off.linear());
    report.better_travel = inertial_off.translation().norm() < steady_off.translation().norm();
  }
  report.bridged_gap = pending_->gap;
  bridged_at_ = pending_->gap > 0.0 ? std::optional(prediction.state.stamp) : bridged_at_;
  const StateEstimate estimate = graph_->add(std::move(pending_->readings), measurement);
  pending_.reset();
  if (const auto failed = failed_check(estimate)) {
    after_gap_ = false;
    lose(*failed);
    if (alignment != nullptr) {
      unexplained_ = kUnexplained;
      monitor_.forget_turns();
    }
    return;
  }
  losses_ = ++fused_sweeps_ > kLongFusion ? 0 : losses_;
  last_fused_ = estimate.state;
  if (rested_at_ && (estimate.state.T_map_body.translation() - *rested_at_).norm() > kFarFromRest) {
    rested_at_.reset();
  }
  report.nav = estimate.state;
  report.nav_covariance = estimate.covariance;
  report.lidar_covariance += lidar_covariance(estimate.covariance, T_body_lidar_);
}

}  // namespace adit
