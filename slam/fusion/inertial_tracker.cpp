// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/inertial_tracker.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace adit {
namespace {

using std::chrono::milliseconds;

// Errors of alignments, as measured (docs/theory/inertial.md, section 9): all of them; what is new
// with each sweep is less (fused_motion.cpp).
constexpr CovarianceModel kAlignmentModel{.kappa = 0.3,
                                          .area = 0.016,
                                          .sigma_translation = 0.002,
                                          .sigma_rotation = 0.0003,
                                          .sigma_unknown_translation = 0.1,
                                          .sigma_unknown_rotation = 0.02};
// Of poses that are fused: large surfaces do not count against them, since innovations tell how
// large errors are.
constexpr CovarianceModel kFusedModel = [] {
  CovarianceModel model = kAlignmentModel;
  model.most_sparse = 1.0;
  return model;
}();
// Innovations have the prediction's errors besides.
constexpr double kOwnShare = 0.5;
// An axis that has not changed since a check failed keeps the sensor out for so long at most.
constexpr Nanoseconds kAxisWaits = std::chrono::seconds(20);
constexpr int kLosses = 5;             // without a long time of fusion in between
constexpr int kLongFusion = 100;       // sweeps
constexpr double kScaleError = 0.005;  // share of readings: scale, axes that are not square
// A gap that was bridged explains for this long what goes wrong.
constexpr Nanoseconds kGapTells = std::chrono::seconds(2);
// Readings stand for this long after the last one; then velocities stay as they were.
constexpr Nanoseconds kHeld = milliseconds(20);
// The sign of an accelerometer that started at rest is confirmed after this way.
constexpr double kFarFromRest = 2.0;  // m
/// Directions, map axes, in which no match held the position.
std::vector<Eigen::Vector3d> unheld_directions(const RegistrationResult& alignment) {
  std::vector<Eigen::Vector3d> directions;
  for (const ObservedDirection& direction : alignment.translation) {
    if (direction.localizability == Localizability::none && !direction.axis.isZero()) {
      directions.push_back(alignment.T_target_source.linear() * direction.axis);
    }
  }
  return directions;
}

bool holds_rotation(const RegistrationResult& alignment) {
  return std::ranges::none_of(alignment.rotation, [](const ObservedDirection& direction) {
    return direction.localizability == Localizability::none && !direction.axis.isZero();
  });
}

/// Covariance of a lidar pose from that of the body's.
Matrix6d lidar_covariance(const StateMatrix& covariance, const Eigen::Isometry3d& T_body_lidar) {
  const Matrix6d to_lidar = adjoint(T_body_lidar.inverse());
  return to_lidar * covariance.topLeftCorner<6, 6>() * to_lidar.transpose();
}

/// Standard deviations of a pose, ordered as its covariance.
Vector6d pose_sigma(const Matrix6d& of_lidar) {
  Vector6d floor;
  floor << 0.005, 0.005, 0.005, 0.001, 0.001, 0.001;
  return (of_lidar.diagonal().cwiseMax(0.0) + floor.cwiseAbs2()).cwiseSqrt();
}

/// A covariance of T_map_lidar without that of its position along directions of the map.
Matrix6d without(Matrix6d of_lidar, const std::vector<Eigen::Vector3d>& directions,
                 const Eigen::Isometry3d& T_map_lidar) {
  for (const Eigen::Vector3d& direction : directions) {
    const Eigen::Vector3d along = T_map_lidar.linear().transpose() * direction;
    Matrix6d across = Matrix6d::Identity();
    across.topLeftCorner<3, 3>() -= along * along.transpose();
    of_lidar = across * of_lidar * across;
  }
  return of_lidar;
}

/// Says which of two predictions of an alignment was nearer.
void compare(const Eigen::Isometry3d& found, const Eigen::Isometry3d& inertial,
             const Eigen::Isometry3d& steady, InertialReport& report) {
  const Eigen::Isometry3d inertial_off = found.inverse() * inertial;
  const Eigen::Isometry3d steady_off = found.inverse() * steady;
  report.compared = true;
  report.better_turn = rotation_angle(inertial_off.linear()) < rotation_angle(steady_off.linear());
  report.better_travel = inertial_off.translation().norm() < steady_off.translation().norm();
}

}  // namespace

ImuNoise imu_noise(const ImuConfig& config) {
  ImuNoise noise = imu_preset(config.sensor, config.noise_scale)
                       .value_or(ImuNoise{.gyro = config.gyro_noise,
                                          .accel = config.accel_noise,
                                          .gyro_walk = config.gyro_walk,
                                          .accel_walk = config.accel_walk});
  noise.scale = kScaleError;
  return noise;
}

InertialTracker::InertialTracker(const ImuConfig& config, double configured_offset,
                                 const VelocityConfig& velocity)
    : config_(config),
      noise_(imu_noise(config)),
      T_body_lidar_(config.T_imu_lidar ? pose_of(*config.T_imu_lidar)
                                       : Eigen::Isometry3d::Identity()),
      velocity_(velocity),
      T_lidar_velocity_(velocity.T_lidar_sensor ? pose_of(*velocity.T_lidar_sensor)
                                                : Eigen::Isometry3d::Identity()),
      readings_(config),
      watch_(config, configured_offset) {}

void InertialTracker::mount(const Eigen::Isometry3d& T_imu_lidar) {
  T_body_lidar_ = T_imu_lidar;
  if (!is<Absent>()) {
    state_ = Starting{};
    history_ = {};
    watch_.forget();
  }
}

std::vector<TakenReading> InertialTracker::add(const ImuSample& sample) {
  std::vector<TakenReading> taken = readings_.add(sample);
  for (const TakenReading& one : taken) {
    if (one.arrival == ImuArrival::appended || one.arrival == ImuArrival::restarted) {
      watch_.add(one.sample);
    }
    if (one.arrival == ImuArrival::restarted) {
      history_.failed_at.reset();  // by the clock from before
    }
    if (one.arrival == ImuArrival::appended && is<Absent>() && config_.use) {
      state_ = Starting{};
    }
  }
  return taken;
}

StartCollection* InertialTracker::collected() {
  if (auto* starting = std::get_if<Starting>(&state_)) {
    return &starting->collected;
  }
  auto* lost = std::get_if<Lost>(&state_);
  return lost != nullptr ? &lost->collected : nullptr;
}

std::vector<ImuSample> InertialTracker::scaled(std::vector<ImuSample> samples) const {
  return history_.accel_scale == 1.0 ? std::move(samples)
                                     : with_accel_scale(samples, history_.accel_scale);
}

std::optional<CoverageFault> InertialTracker::fault_of(const ImuInterval& interval) const {
  return coverage_fault(interval, config_.max_gap);
}

std::optional<InertialPrediction> InertialTracker::predict(Nanoseconds stamp, double duration) {
  timed_ = timed_ || duration > 0.0;  // a sweep without points has no times
  auto* fused = std::get_if<Fused>(&state_);
  if (fused == nullptr) {
    return std::nullopt;
  }
  fused->motion.forget_prediction();
  return stamp > fused->motion.latest().stamp ? predict(*fused, stamp, duration) : std::nullopt;
}

std::optional<InertialPrediction> InertialTracker::predict(Fused& fused, Nanoseconds stamp,
                                                           double duration) {
  const Nanoseconds last = fused.motion.latest().stamp;
  const ImuInterval interval = readings_.between(last, stamp);
  if (const auto fault = fault_of(interval)) {
    std::visit([this](const auto& one) { leave(Lost{.after_gap = true}, one); }, *fault);
    return std::nullopt;
  }
  if (const auto stuck = readings_.stuck()) {
    leave(Lost{}, *stuck);
    return std::nullopt;
  }
  if (const auto saturation = readings_.saturation_begins(last, stamp)) {
    event_ = InertialEvent{.cause = *saturation};
  }
  const double silence = interval.longest_silence();
  fused.gap = silence > kReadingGap ? silence : 0.0;
  const auto outcome = fused.motion.predict(scaled(interval.samples));
  if (const auto* failed = std::get_if<FailedCheck>(&outcome)) {
    lose(*failed);
    return std::nullopt;
  }
  const auto& predicted = std::get<StateEstimate>(outcome);

  InertialPrediction result;
  result.lidar.T_map_lidar = T_map_lidar(predicted.state);
  const Matrix6d of_lidar = lidar_covariance(predicted.covariance, T_body_lidar_);
  result.lidar.sigma = pose_sigma(of_lidar);
  result.lidar.information = fused.motion.pose_prior(of_lidar);
  // Where matches hold it: elsewhere a search finds rings of the ground where they were, and
  // nothing else.
  const Vector6d held = pose_sigma(without(of_lidar, fused.unheld, result.lidar.T_map_lidar));
  result.lidar.trusted =
      held.head<3>().maxCoeff() < kTrustedPosition && held.tail<3>().maxCoeff() < kTrustedRotation;
  const Nanoseconds end = stamp + nanoseconds(duration);
  const ImuInterval within = readings_.between(stamp, std::min(end, *readings_.newest() + kHeld));
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
  watch_.note_sweep();
  if (alignment != nullptr) {
    report.lidar_covariance = covariance(*alignment, kAlignmentModel);
  }
  if (auto* fused = std::get_if<Fused>(&state_)) {
    if (fused->motion.prediction() != nullptr) {
      fuse(*fused, alignment, steady, report);
    }
  } else if (collected() != nullptr) {
    if (alignment != nullptr) {
      compare_velocities(T_map_lidar.stamp, *alignment);
      collect(T_map_lidar, unheld_directions(*alignment));
    } else {
      collected()->note_unaligned(T_map_lidar.stamp);
    }
    start_if_possible();
  }
  if (report.compared) {
    if (const auto worse = watch_.note_prediction(report.better_turn)) {
      leave(Refused{}, *worse);
    }
  }
  // Turns that no match holds are the prediction's own. A sweep that was not aligned interrupts
  // nothing: the next turn is the one since the last that was.
  if (alignment != nullptr && holds_rotation(*alignment)) {
    watch({T_map_lidar.stamp, matched_pose(*alignment)}, deskewed);
  } else if (alignment != nullptr) {
    watch_.broken();
  }
  if (!is<Fused>()) {
    report.nav.reset();
  }
  const StartCollection* waiting = collected();
  readings_.forget_before(waiting == nullptr || waiting->poses().empty()
                              ? T_map_lidar.stamp
                              : waiting->poses().front().stamp);
  for (VelocityBuffer& source : velocities_) {
    source.forget_before(T_map_lidar.stamp);
  }
  report.state = state();
  report.event = std::exchange(event_, std::nullopt);
  report.hindrance = hindrance_;
  report.accel_scale = history_.accel_scale;
  report.T_body_lidar = T_body_lidar_;
  report.clock_offset = readings_.clock_offset();
  report.comparison = watch_.comparison();
  report.gravity_map = history_.fused ? history_.fused->gravity_map : Eigen::Vector3d::Zero();
  return report;
}

void InertialTracker::fuse(Fused& fused, const RegistrationResult* alignment,
                           const Eigen::Isometry3d& steady, InertialReport& report) {
  const NavState predicted = fused.motion.prediction()->state;
  if (alignment != nullptr) {
    compare(matched_pose(*alignment), T_map_lidar(predicted), steady, report);
    fused.unheld = unheld_directions(*alignment);
  }
  report.bridged_gap = fused.gap;
  if (fused.gap > 0.0) {
    history_.bridged_at = predicted.stamp;
  }
  const FusedSweep sweep = fused.motion.fuse(alignment, T_body_lidar_,
                                             {.before = history_.fused,
                                              .timed = timed_,
                                              .sign_assumed = history_.is_sign_assumed(),
                                              .sure = !passing_cause()},
                                             ways_until(predicted.stamp, fused.motion.latest()));
  report.innovation = sweep.innovation;
  report.innovation_gate = sweep.innovation_gate;
  report.velocities = sweep.velocities;
  report.shares = sweep.shares;
  if (const auto* failed = std::get_if<FailedCheck>(&sweep.outcome)) {
    lose(*failed);
    if (alignment != nullptr && !stuck_axis()) {
      watch_.accuse();
    }
    return;
  }
  const auto& estimate = std::get<StateEstimate>(sweep.outcome);
  if (fused.motion.sweeps() > kLongFusion) {
    history_.losses = 0;
    history_.moved_unclearly = false;
  }
  history_.fused = estimate.state;
  const Eigen::Vector3d& position = estimate.state.T_map_body.translation();
  if (history_.rested_at && (position - *history_.rested_at).norm() > kFarFromRest) {
    history_.rested_at.reset();
  }
  report.nav = estimate.state;
  report.nav_covariance = estimate.covariance;
  report.lidar_covariance = lidar_covariance(estimate.covariance, T_body_lidar_);
  if (alignment != nullptr) {
    report.lidar_covariance =
        kOwnShare * sweep.scale * (report.lidar_covariance + covariance(*alignment, kFusedModel));
  }
}

void InertialTracker::add(const BodyVelocity& velocity, VelocitySource source) {
  velocities_[static_cast<size_t>(source)].add(velocity);
}

std::vector<MeasuredDisplacement> InertialTracker::ways_until(Nanoseconds stamp,
                                                              const NavState& from) const {
  const std::array mountings = {Eigen::Isometry3d(T_body_lidar_ * T_lidar_velocity_),
                                T_body_lidar_};
  std::vector<MeasuredDisplacement> ways;
  for (size_t i = 0; i < kVelocitySources; ++i) {
    if (velocities_[i].empty()) {
      continue;
    }
    if (auto way =
            measured_displacement(velocities_[i], readings_.between(from.stamp, stamp).samples,
                                  from.bias.gyro, mountings[i], velocity_.sigma)) {
      way->source = static_cast<VelocitySource>(i);
      ways.push_back(*way);
    }
  }
  return ways;
}

void InertialTracker::watch(const StampedPose& alignment, const SweepMotion* deskewed) {
  if (is<Absent>() || is<Refused>()) {
    return;
  }
  if (const auto stuck = stuck_axis(); stuck && stuck->gyroscope) {
    watch_.forget();
    return;
  }
  const auto verdict =
      watch_.check(alignment, deskewed,
                   {.T_body_lidar = T_body_lidar_, .clock_offset = readings_.clock_offset()},
                   readings_.saturated_gyroscope(), timed_);
  if (!verdict) {
    return;
  }
  if (const auto* correction = std::get_if<FrameCorrection>(&*verdict)) {
    if (correction->what.clock) {
      readings_.correct_clock(correction->frame.clock_offset);
    }
    T_body_lidar_ = correction->frame.T_body_lidar;
    leave(Starting{}, correction->what);
    return;
  }
  const auto& found = std::get<GyroscopeDisagrees>(*verdict);
  const bool moves_not =
      found.check.fault == GyroFault::constant || found.check.fault == GyroFault::unrelated;
  if (moves_not && lose_by_axis()) {
    watch_.forget();
    return;
  }
  const auto* lost = std::get_if<Lost>(&state_);
  const bool after_gap = lost != nullptr && lost->after_gap;
  leave(found.refused ? State(Refused{}) : State(Lost{.after_gap = after_gap}), found);
}

std::optional<StuckAxis> InertialTracker::stuck_axis() const {
  const auto stuck = readings_.stuck();
  const bool failed = history_.failed_at && *readings_.newest() - *history_.failed_at < kAxisWaits;
  return stuck || !failed ? stuck : readings_.unchanged_axis(*history_.failed_at);
}

std::optional<PassingCause> InertialTracker::passing_cause() const {
  if (const auto saturation = readings_.recent_saturation()) {
    return *saturation;
  }
  const auto* fused = std::get_if<Fused>(&state_);
  const bool bridged = fused != nullptr && history_.bridged_at &&
                       fused->motion.latest().stamp - *history_.bridged_at < kGapTells;
  return bridged ? std::optional<PassingCause>(GapBridged{}) : std::nullopt;
}

void InertialTracker::lose(const FailedCheck& check) {
  const bool by_readings = std::holds_alternative<AlignmentsContradict>(check) ||
                           std::holds_alternative<ImpossibleState>(check);
  if (by_readings && lose_by_axis()) {
    return;
  }
  history_.losses += passing_cause() ? 0 : 1;  // else it is known why, and passes
  const bool again = history_.losses >= kLosses;
  leave(again ? State(Refused{}) : State(Lost{}),
        CheckFailed{.check = check, .losses = history_.losses, .refused = again});
}

bool InertialTracker::lose_by_axis() {
  history_.failed_at = *readings_.newest();
  const auto axis = stuck_axis();
  if (!axis || history_.losses + 1 >= kLosses) {
    return false;
  }
  ++history_.losses;
  leave(Lost{}, *axis);
  return true;
}

void InertialTracker::leave(State next, const InertialCause& why) {
  InertialEvent& event = event_.emplace();
  event.cause = why;
  event.passing = passing_cause();
  state_ = std::move(next);
  hindrance_.reset();
}

}  // namespace adit
