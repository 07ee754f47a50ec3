// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/odometry.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "adit/slam/odometry/odometry_impl.hpp"
#include "adit/slam/odometry/possible_pose.hpp"
#include "adit/slam/registration/beam_spacing.hpp"

namespace adit {
namespace {

// A time without sweeps that is so many times as long as usual is a silence.
constexpr double kOutOfRhythm = 2.5;
// Of alignments that are accepted after a silence this share is of another place, at the most
// (docs/theory/odometry.md, section 3).
constexpr double kOtherPlaceShare = 0.01;

/// Covariance of a pose about which no more is known than what the sensor may have done.
Matrix6d moved_meanwhile(const Silence& silence, const Eigen::Isometry3d& T_map_lidar) {
  const Vector6d off = se3_log(silence.T_map_lidar.inverse() * T_map_lidar);
  return (silence.sigma.cwiseAbs2() + off.cwiseAbs2()).asDiagonal();
}

}  // namespace

std::string_view to_string(OdometryState state) {
  switch (state) {
    case OdometryState::initializing:
      return "initializing";
    case OdometryState::tracking:
      return "tracking";
    case OdometryState::coasting:
      return "coasting";
    case OdometryState::restarted:
      return "restarted";
  }
  return "unknown";
}

Odometry::Odometry(engine::Context& context, const Config& config)
    : stated_(config), impl_(std::make_unique<Impl>(context, with_lengths(config))) {}
Odometry::~Odometry() = default;

const Config& Odometry::config() const {
  return impl_->config;
}

// Before the first sweep that tells anything nothing is on the device.
void Odometry::derive_lengths(const Sweep& sweep) {
  const auto voxel = derived_ ? std::nullopt : measured_voxel_size(sweep.points);
  if (!voxel) {
    return;
  }
  derived_ = true;
  const Config derived = with_lengths(stated_, *voxel);
  if (derived.preprocess.r_input != impl_->config.preprocess.r_input && impl_->submap.empty()) {
    impl_->use_lengths(derived);
  }
}

void Odometry::Impl::use_lengths(const Config& derived) {
  config = derived;
  front_end.use_lengths(derived.preprocess);
  submap.use_lengths(derived);
  aligner.use_lengths(derived.registration);
}

SweepResult Odometry::step(const Sweep& sweep) {
  begin(sweep);
  return finish();
}

void Odometry::begin(const Sweep& sweep) {
  assert(!impl_->pending && "the last sweep has not been finished");
  const auto start = std::chrono::steady_clock::now();
  SweepResult result;
  result.stamp = sweep.stamp;
  result.raw_points = static_cast<int>(sweep.points.size());
  derive_lengths(sweep);
  if (!impl_->front_end.knows_beam_spacing()) {
    impl_->front_end.measure_beam_spacing(sweep.points);
  }
  impl_->front_end.upload(sweep);
  Expectation expected = impl_->expect(sweep);
  impl_->end_track_if_beyond_reach(sweep, expected, result);
  impl_->rhythm.add(sweep);
  const bool aligns = !impl_->submap.empty();
  engine::Submission submission = impl_->submit(expected);
  result.host_ms = milliseconds_since(start);
  result.clock = {.begun = start, .submitted = std::chrono::steady_clock::now()};
  impl_->pending.emplace(PendingSweep{.result = std::move(result),
                                      .expected = std::move(expected),
                                      .submission = std::move(submission),
                                      .aligns = aligns,
                                      .reach = reach_of(sweep.points)});
  if (!aligns || impl_->first) {
    impl_->pending->sweep = sweep;
  }
}

SweepResult Odometry::finish() {
  assert(impl_->pending && "no sweep has been begun");
  PendingSweep pending = std::move(*impl_->pending);
  impl_->pending.reset();
  SweepResult& result = pending.result;
  impl_->wait(pending.submission, result);
  const auto start = std::chrono::steady_clock::now();
  result.clock.done = start;
  const double waited = result.wait_ms;
  if (pending.aligns) {
    impl_->align_on(result);
  }
  impl_->read_back(pending);
  if (pending.aligns) {
    impl_->search_again(pending.expected, result);
    impl_->judge(pending.expected, result);
    impl_->begin_again(pending);
  }
  impl_->fuse(pending.expected, result);
  result.displacement_measured =
      pending.expected.measured && result.inertial.state == InertialState::starting;
  result.state = impl_->decide(pending.expected, result);
  if (result.state != OdometryState::coasting) {
    impl_->reach = pending.reach;
  }
  impl_->assess(pending.expected, result);
  if (result.state == OdometryState::initializing) {
    impl_->first = std::move(pending.sweep);
  }
  if (impl_->is_keyframe(result)) {
    result.keyframe = true;
    result.cloud = impl_->front_end.read_cloud();
  }
  result.host_ms += milliseconds_since(start) - (result.wait_ms - waited);
  result.clock.ended = std::chrono::steady_clock::now();
  return std::move(result);
}

std::vector<Point> Odometry::cloud() const {
  return impl_->front_end.read_cloud();
}

void Odometry::mount(const Eigen::Isometry3d& T_imu_lidar) {
  impl_->inertial.mount(T_imu_lidar);
}

std::vector<TakenReading> Odometry::add(const ImuSample& sample) {
  return impl_->inertial.add(sample);
}

void Odometry::add(const BodyVelocity& velocity, VelocitySource source) {
  impl_->inertial.add(velocity, source);
}

void Odometry::mount_velocity(const Eigen::Isometry3d& T_lidar_sensor) {
  impl_->inertial.mount_velocity(T_lidar_sensor);
}

// At constant velocity; where that leads nowhere, as stamps a moment apart make it, the sensor
// stays where it was.
Prediction Odometry::Impl::possible_prediction(Nanoseconds stamp) const {
  Prediction prediction = motion.predict(stamp);
  if (impossible_pose({stamp, prediction.T_map_lidar}, motion.last(), config.recovery.max_speed)) {
    prediction.T_map_lidar = motion.last()->pose;
    prediction.T_map_onward = motion.last()->pose;
    prediction.trusted = false;
  }
  return prediction;
}

// By inertia where that is known, at constant velocity otherwise.
Expectation Odometry::Impl::expect(const Sweep& sweep) {
  const double duration = config.preprocess.deskew ? duration_of(sweep) : 0.0;
  const std::optional<StampedPose>& last = motion.last();
  Expectation expected;
  expected.prediction = possible_prediction(sweep.stamp);
  if (submap.empty()) {
    expected.prediction.T_map_lidar.linear() =
        level_attitude(sweep).value_or(expected.prediction.T_map_lidar.linear());
  }
  // A sensor that hardly moves and whose readings are quiet is at rest: a velocity of directions
  // that no match holds would be noise, and feed on itself.
  at_rest = last && hardly_moved && inertial.is_quiet_between(last->stamp, sweep.stamp);
  if (at_rest) {
    expected.prediction.T_map_lidar = last->pose;
  }
  expected.steady = expected.prediction.T_map_lidar;
  const Vector6d velocity =
      expected.prediction.moving ? motion.deskewing_twist() : Vector6d(Vector6d::Zero());
  if (expected.prediction.moving && duration > 0.0) {
    expected.motion = steady_motion(velocity, 0.0, duration);
  }
  if (const auto turning = inertial.turning_motion(sweep.stamp, duration, velocity.head<3>())) {
    expected.motion = turning;
  }
  if (const auto turn = last ? inertial.turn(last->stamp, sweep.stamp) : std::nullopt) {
    expected.prediction.T_map_lidar.linear() = last->pose.linear() * *turn;
  }
  if (const auto measured =
          last ? inertial.measured_motion(last->stamp, sweep.stamp) : std::nullopt) {
    expected.measured = true;
    expected.prediction = {.T_map_lidar = last->pose * measured->T_begin_end,
                           .trusted = true,
                           .moving = true,
                           .information = pose_prior(measured->covariance),
                           .sigma = measured->covariance.diagonal().cwiseSqrt()};
    expected.motion = inertial.turning_motion(
        sweep.stamp, duration,
        measured->T_begin_end.translation() / seconds(sweep.stamp - last->stamp));
  }
  const auto start = std::chrono::steady_clock::now();
  if (const auto predicted = inertial.predict(sweep.stamp, duration)) {
    expected.measured = true;
    expected.prediction = predicted->lidar;
    expected.motion = predicted->motion;
  }
  expected.inertial_ms = milliseconds_since(start);
  if (!config.preprocess.deskew || !front_end.has_times()) {
    expected.motion.reset();
  }
  expected.silence = silence_before(sweep.stamp, expected);
  return expected;
}

// As the readings of the sweep's time have it.
std::optional<Eigen::Matrix3d> Odometry::Impl::level_attitude(const Sweep& sweep) const {
  const double duration = config.preprocess.deskew ? duration_of(sweep) : 0.0;
  return inertial.level_lidar(sweep.stamp, sweep.stamp + nanoseconds(std::max(duration, 0.1)));
}

// What sweeps that are always far apart leave between them is none.
std::optional<Silence> Odometry::Impl::silence_before(Nanoseconds stamp,
                                                      const Expectation& expected) const {
  const std::optional<double> usual = rhythm.usual();
  const double unseen = motion.unseen(stamp);
  const bool has_track = !submap.empty() || track_ended;
  if (!has_track || !usual || unseen <= std::max(kLongestExtrapolation, kOutOfRhythm * *usual) ||
      (expected.measured && expected.prediction.trusted)) {
    return std::nullopt;
  }
  Silence silence = motion.silence_until(stamp);
  if (expected.measured) {
    const Eigen::Vector3d way =
        expected.prediction.T_map_lidar.translation() - motion.last()->pose.translation();
    silence.T_map_lidar = expected.prediction.T_map_lidar;
    silence.sigma = expected.prediction.sigma;
    silence.distance = way.norm() + kPlanarSigmas * silence.sigma.head<3>().maxCoeff();
  }
  return silence;
}

// Where the sensor may be, the submap is not: whatever fits it, fits by chance.
void Odometry::Impl::end_track_if_beyond_reach(const Sweep& sweep, Expectation& expected,
                                               SweepResult& result) {
  const std::optional<Silence>& silence = expected.silence;
  result.silence = silence ? silence->seconds : 0.0;
  if (!submap.empty() && silence && silence->distance > reach) {
    submap.clear();
    track_ended = true;
  }
  if (track_ended && silence) {
    expected.prediction.T_map_lidar.linear() =
        level_attitude(sweep).value_or(expected.prediction.T_map_lidar.linear());
    result.registration.status = RegistrationStatus::doubtful;
    result.rejection =
        BeyondReach{.seconds = silence->seconds, .distance = silence->distance, .reach = reach};
  }
}

// The pose is the alignment's, the prediction where it failed, and with an inertial sensor what the
// sliding graph makes of them.
void Odometry::Impl::fuse(const Expectation& expected, SweepResult& result) {
  const bool aligned = is_usable(result.registration.status);
  const bool starts = submap.empty() && !track_ended;
  result.T_map_lidar =
      aligned ? result.registration.T_target_source : expected.prediction.T_map_lidar;
  if (starts && result.cloud_points < config.registration.min_inliers) {
    return;
  }
  const RegistrationResult* alignment = aligned ? &result.registration : nullptr;
  const auto start = std::chrono::steady_clock::now();
  result.inertial = inertial.update({result.stamp, result.T_map_lidar}, alignment, expected.steady,
                                    expected.motion ? &*expected.motion : nullptr);
  result.inertial_ms = expected.inertial_ms + milliseconds_since(start);
  if (starts) {
    inertial.note_begin({result.stamp, result.T_map_lidar});
  }
  if (result.inertial.nav) {
    result.T_map_lidar = inertial.T_map_lidar(*result.inertial.nav);
  }
}

// The policy of success, failure and recovery (docs/theory/odometry.md).
OdometryState Odometry::Impl::decide(const Expectation& expected, SweepResult& result) {
  const auto points = static_cast<uint32_t>(result.cloud_points);
  const bool can_start = result.cloud_points >= config.registration.min_inliers;
  const bool aligned = is_usable(result.registration.status);
  const StampedPose pose{result.stamp, result.T_map_lidar};
  joined = false;

  if (aligned) {
    failures_in_a_row = 0;
    // Once at rest, it is that until matches hold a motion.
    const bool slides = at_rest && hardly_moves(result.registration, *motion.last(), pose);
    motion.update(pose, true);
    hardly_moved = slides || motion.speed() < kHardlyMoves;
    joined = submap.wants(pose.pose);
    if (joined) {
      submap.push(points, pose.pose);
    }
    return OdometryState::tracking;
  }
  const bool begins = submap.empty() && !track_ended;
  const bool gives_up = track_ended || failures_in_a_row >= config.recovery.max_coasting;
  if (can_start && (begins || gives_up)) {
    failures_in_a_row = 0;
    track_ended = false;
    motion.restart(pose);
    submap.clear();
    usual_fit.forget();
    if (!begins) {
      inertial.note_restart();
    }
    submap.push(points, pose.pose);
    result.renewed = !begins && expected.measured && expected.prediction.trusted;
    return begins           ? OdometryState::initializing
           : result.renewed ? OdometryState::coasting
                            : OdometryState::restarted;
  }
  ++failures_in_a_row;
  if (can_start) {
    motion.update(pose, false);
  }  // else too few points tell nothing: the motion goes on as if the sweep had not come
  return OdometryState::coasting;
}

// How well the pose is known. A sweep that coasts, or restarts, is known as its prediction is,
// after a silence as well as the sensor may have moved; what a restart misses stays missed. An
// alignment after a silence may be of another place that fits: then no more is known either.
void Odometry::Impl::assess(const Expectation& expected, SweepResult& result) {
  Matrix6d local = result.inertial.lidar_covariance;
  const bool predicted = local.isZero() && result.state != OdometryState::initializing;
  if (predicted) {
    coasting += expected.prediction.sigma.cwiseAbs2().asDiagonal();
    local = expected.silence ? moved_meanwhile(*expected.silence, result.T_map_lidar) : coasting;
  } else {
    coasting.setZero();
  }
  if (result.state == OdometryState::initializing) {
    map_began = result.stamp;
  }
  if (starts_at_rest_since(map_began, result.inertial)) {
    result.rested = true;
    unmeasured = {};
    drift.note_rest();
  }
  Matrix6d besides = Matrix6d::Zero();
  if (result.state == OdometryState::tracking && !result.inertial.nav) {
    besides = unmeasured.step({result.stamp, result.T_map_lidar}, expected.steady,
                              unheld_directions(result.registration));
    result.leapt = unmeasured.leapt();
  } else if (result.inertial.nav) {
    unmeasured = {};
  }
  if (result.state == OdometryState::tracking && expected.silence) {
    besides += kOtherPlaceShare * moved_meanwhile(*expected.silence, result.T_map_lidar);
  }
  result.uncertainty = drift.update(result.T_map_lidar, local, joined, besides);
  if (result.state == OdometryState::restarted || result.renewed) {
    result.uncertainty = drift.restart(local);
  }
}

bool Odometry::Impl::is_keyframe(const SweepResult& result) {
  if (result.state == OdometryState::coasting) {
    return false;
  }
  if (last_keyframe) {
    const Eigen::Isometry3d moved = last_keyframe->inverse() * result.T_map_lidar;
    if (moved.translation().norm() < config.keyframe.delta_trans &&
        rotation_angle(moved.linear()) < config.keyframe.delta_rot) {
      return false;
    }
  }
  last_keyframe = result.T_map_lidar;
  return true;
}

}  // namespace adit
