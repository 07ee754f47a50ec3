// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/inertial_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "adit/slam/core/text.hpp"

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
constexpr int kSurprises = 3;              // in a row are a failure
constexpr double kFastest = 100.0;         // m/s
constexpr double kLargestGyroBias = 0.3;   // rad/s
constexpr double kLargestAccelBias = 3.0;  // m/s²
constexpr double kLongestAlone = 3.0;      // s by inertia alone
constexpr int kLosses = 5;                 // without a long time of fusion in between
constexpr int kLongFusion = 100;           // sweeps
constexpr double kScaleError = 0.005;      // of readings: scale, axes that are not square
// After a check that failed the sweeps are to tell what is wrong, without the sensor: for so many.
constexpr int kUnexplained = 50;
// Saturation is told when none was for so long, and with what else goes wrong in that time.
constexpr Nanoseconds kToldAgain = std::chrono::seconds(10);
// Readings stand for this long after the last one; then velocities stay as they were.
constexpr Nanoseconds kHeld = milliseconds(20);
// What the sign of an accelerometer is believed after, which started at rest.
constexpr double kFarFromRest = 2.0;  // m
// What a prediction must be better than to be aligned from without a search.
constexpr double kTrustedPosition = 0.25;  // m
constexpr double kTrustedRotation = 0.05;  // rad

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
      configured_offset_(configured_offset) {}

ImuArrival InertialTracker::add(const ImuSample& sample) {
  ImuSample corrected = sample;
  corrected.stamp -= std::chrono::round<Nanoseconds>(std::chrono::duration<double>(clock_offset_));
  const ImuArrival arrival = buffer_.push(corrected);
  if (arrival == ImuArrival::restarted) {
    saturation_ = {};
  }
  if (arrival == ImuArrival::appended || arrival == ImuArrival::restarted) {
    monitor_.add(sample);
    saturation_.add(corrected);
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
  if (state_ == InertialState::absent || !complaint(interval).empty() || !(sum.norm() > 0.0)) {
    return std::nullopt;
  }
  return level_attitude(T_body_lidar_.linear().transpose() * sum);
}

std::vector<ImuSample> InertialTracker::scaled(std::vector<ImuSample> samples) const {
  return accel_scale_ == 1.0 ? std::move(samples) : with_accel_scale(samples, accel_scale_);
}

std::string InertialTracker::complaint(const ImuInterval& interval) const {
  const double longest =
      std::max({interval.held_before, interval.held_after, interval.longest_gap});
  if (interval.samples.empty()) {
    return "there are no IMU readings";
  }
  return longest <= config_.max_gap ? ""
                                    : "no IMU readings for " + in_digits(longest) +
                                          " s (imu.max_gap is " + in_digits(config_.max_gap) + ")";
}

void InertialTracker::lose(const std::string& why) {
  losses_ += recent_saturation().empty() ? 1 : 0;  // else it is known why, and passes
  const bool again = losses_ >= kLosses;
  leave(again ? InertialState::refused : InertialState::lost,
        why + (again ? "; lost " + std::to_string(losses_) +
                           " times, so it is not used any more: check its mounting "
                           "(imu.T_imu_lidar), its clock and its units with adit inspect"
                     : ""));
}

std::string InertialTracker::recent_saturation() const {
  return buffer_.empty()
             ? ""
             : saturation_.evidence(buffer_.back().stamp - kToldAgain, buffer_.back().stamp);
}

void InertialTracker::leave(InertialState state, const std::string& why) {
  const std::string saturated = recent_saturation();
  state_ = state;
  event_ = why + (saturated.empty() ? "" : "; " + saturated);
  graph_.reset();
  pending_.reset();
  poses_.clear();
  readings_.clear();
  surprises_ = 0;
  fused_sweeps_ = 0;
  alone_since_ = 0.0;
}

std::optional<InertialPrediction> InertialTracker::predict(Nanoseconds stamp, double duration) {
  pending_.reset();
  timed_ = duration > 0.0;
  if (state_ != InertialState::fused || stamp <= graph_->latest().stamp) {
    return std::nullopt;
  }
  const ImuInterval interval = buffer_.between(graph_->latest().stamp, stamp);
  if (const std::string wrong = complaint(interval); !wrong.empty()) {
    lose(wrong);
    after_gap_ = true;
    return std::nullopt;
  }
  const Nanoseconds last = graph_->latest().stamp;
  if (saturation_.evidence(last - kToldAgain, last).empty()) {
    event_ = saturation_.evidence(last, stamp);
  }
  pending_ = Pending{.readings = scaled(interval.samples), .prediction = {}};
  pending_->prediction = graph_->predict(pending_->readings);
  const StateEstimate& predicted = pending_->prediction;

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
  if (alignment != nullptr) {
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
  report.event = std::exchange(event_, {});
  report.hindrance = hindrance_;
  report.accel_scale = accel_scale_;
  report.T_body_lidar = T_body_lidar_;
  report.clock_offset = clock_offset_;
  report.comparison = comparison_;
  report.gravity_map = last_fused_ ? last_fused_->gravity_map : Eigen::Vector3d::Zero();
  return report;
}

std::string InertialTracker::failed_check(const StateEstimate& estimate) const {
  const NavState& nav = estimate.state;
  if (!nav.T_map_body.matrix().allFinite() || !nav.v_map_body.allFinite() ||
      !estimate.covariance.allFinite()) {
    return "the fused state is not finite";
  }
  if (nav.v_map_body.norm() > kFastest) {
    return "the fused velocity is " + in_digits(nav.v_map_body.norm()) + " m/s";
  }
  if (nav.bias.gyro.norm() > kLargestGyroBias) {
    return "the gyroscope's bias would be " + in_digits(nav.bias.gyro.norm()) +
           " rad/s: is it saturated, in degrees, or mounted otherwise than imu.T_imu_lidar says?";
  }
  if (nav.bias.accel.norm() > kLargestAccelBias) {
    return "the accelerometer's bias would be " + in_digits(nav.bias.accel.norm()) +
           " m/s^2: is its unit another, or imu.T_imu_lidar wrong?";
  }
  if (surprises_ >= kSurprises) {
    return std::to_string(surprises_) +
           " alignments in a row are where the IMU says that they cannot be: are clock and "
           "imu.T_imu_lidar right?" +
           (rested_at_ && recent_saturation().empty()
                ? " And the accelerometer's sign, which a start at rest cannot tell from a "
                  "sensor upside down?"
                : "");
  }
  return alone_since_ > kLongestAlone
             ? "no sweep could be aligned for " + in_digits(alone_since_) + " s"
             : "";
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
  const StateEstimate estimate = graph_->add(std::move(pending_->readings), measurement);
  pending_.reset();
  if (const std::string failed = failed_check(estimate); !failed.empty()) {
    after_gap_ = false;
    lose(failed);
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
