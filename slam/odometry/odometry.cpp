// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/odometry.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/slam/fusion/inertial_tracker.hpp"
#include "adit/slam/odometry/aligner.hpp"
#include "adit/slam/odometry/doubt.hpp"
#include "adit/slam/odometry/motion_model.hpp"
#include "adit/slam/odometry/possible_pose.hpp"
#include "adit/slam/odometry/submap.hpp"
#include "adit/slam/registration/front_end.hpp"

namespace adit {
namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

// The times of scopes outside any other, added up by name.
std::vector<StageTime> stage_times(const engine::Submission& submission) {
  std::vector<StageTime> stages;
  for (const engine::ScopeTime& time : submission.scope_times()) {
    if (time.depth > 0) {
      continue;
    }
    const auto same = [&](const StageTime& stage) { return stage.stage == time.name; };
    const auto found = std::find_if(stages.begin(), stages.end(), same);
    if (found == stages.end()) {
      stages.push_back({time.name, time.device_ms});
    } else {
      found->device_ms += time.device_ms;
    }
  }
  return stages;
}

/// What is expected of a sweep before it is aligned.
struct Expectation {
  Prediction prediction;
  Eigen::Isometry3d steady;           ///< T_map_lidar at constant velocity
  std::optional<SweepMotion> motion;  ///< to de-skew with
  double inertial_ms = 0.0;           ///< host time of the inertial prediction
};

/// A step between its halves.
struct Begun {
  SweepResult result;  ///< what is known of it by now
  Expectation expected;
  engine::Submission submission;
  bool aligns = false;  ///< there is a submap
};

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

struct Odometry::Impl {
  Impl(engine::Context& context_, const Config& config_)
      : context(context_),
        config(config_),
        front_end(context_, config_.preprocess),
        submap(context_, config_),
        aligner(context_, config_.registration),
        inertial(config_.imu, config_.recording.imu_time_offset),
        drift(config_.submap.l) {}

  Expectation expect(const Sweep& sweep);
  Prediction possible_prediction(Nanoseconds stamp) const;
  engine::Submission submit(const Expectation& expected);
  void wait(Begun& sweep);
  void read_back(Begun& sweep);
  void invalidate();
  void judge(const Prediction& prediction, SweepResult& result);
  void fuse(const Expectation& expected, SweepResult& result);
  void assess(const Expectation& expected, SweepResult& result);
  OdometryState decide(SweepResult& result);
  bool is_keyframe(const SweepResult& result);

  engine::Context& context;
  Config config;
  FrontEnd front_end;
  Submap submap;
  Aligner aligner;
  MotionModel motion;
  InertialTracker inertial;
  UsualFit usual_fit;
  DriftModel drift;
  Matrix6d coasting = Matrix6d::Zero();  ///< covariance of predictions in a row
  bool joined = false;                   ///< the last sweep's cloud, the submap
  std::optional<Begun> begun;            ///< a sweep that is on the device
  int failures_in_a_row = 0;
  std::optional<Eigen::Isometry3d> last_keyframe;  ///< T_map_lidar
};

Odometry::Odometry(engine::Context& context, const Config& config)
    : impl_(std::make_unique<Impl>(context, config)) {}
Odometry::~Odometry() = default;

SweepResult Odometry::step(const Sweep& sweep) {
  begin(sweep);
  return finish();
}

void Odometry::begin(const Sweep& sweep) {
  assert(!impl_->begun && "the last sweep has not been finished");
  const auto start = std::chrono::steady_clock::now();
  SweepResult result;
  result.stamp = sweep.stamp;
  result.raw_points = static_cast<int>(sweep.points.size());
  if (!impl_->front_end.knows_beam_spacing()) {
    impl_->front_end.measure_beam_spacing(sweep.points);
  }
  impl_->front_end.upload(sweep);
  Expectation expected = impl_->expect(sweep);
  const bool aligns = !impl_->submap.empty();
  engine::Submission submission = impl_->submit(expected);
  result.host_ms = milliseconds_since(start);
  impl_->begun.emplace(Begun{.result = std::move(result),
                             .expected = std::move(expected),
                             .submission = std::move(submission),
                             .aligns = aligns});
}

SweepResult Odometry::finish() {
  assert(impl_->begun && "no sweep has been begun");
  Begun begun = std::move(*impl_->begun);
  impl_->begun.reset();
  SweepResult& result = begun.result;
  impl_->wait(begun);
  const auto start = std::chrono::steady_clock::now();
  impl_->read_back(begun);
  impl_->fuse(begun.expected, result);
  result.state = impl_->decide(result);
  impl_->assess(begun.expected, result);
  if (impl_->is_keyframe(result)) {
    result.keyframe = true;
    result.cloud = impl_->front_end.read_cloud();
  }
  result.host_ms += milliseconds_since(start);
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
  Expectation expected;
  expected.prediction = possible_prediction(sweep.stamp);
  if (submap.empty()) {
    const auto end = sweep.stamp + std::chrono::round<Nanoseconds>(
                                       std::chrono::duration<double>(std::max(duration, 0.1)));
    expected.prediction.T_map_lidar.linear() =
        inertial.level_lidar(sweep.stamp, end).value_or(expected.prediction.T_map_lidar.linear());
  }
  expected.steady = expected.prediction.T_map_lidar;
  const Vector6d velocity =
      expected.prediction.trusted ? motion.deskewing_twist() : Vector6d(Vector6d::Zero());
  if (expected.prediction.trusted && duration > 0.0) {
    expected.motion = steady_motion(velocity, 0.0, duration);
  }
  if (const auto turning = inertial.turning_motion(sweep.stamp, duration, velocity.head<3>())) {
    expected.motion = turning;
  }
  const std::optional<StampedPose>& last = motion.last();
  if (const auto turn = last ? inertial.turn(last->stamp, sweep.stamp) : std::nullopt) {
    expected.prediction.T_map_lidar.linear() = last->pose.linear() * *turn;
  }
  const auto start = std::chrono::steady_clock::now();
  if (const auto predicted = inertial.predict(sweep.stamp, duration)) {
    expected.prediction = predicted->lidar;
    expected.motion = predicted->motion;
  }
  expected.inertial_ms = milliseconds_since(start);
  if (!config.preprocess.deskew || !front_end.has_times()) {
    expected.motion.reset();
  }
  return expected;
}

// One submission: the last sweep joins the submap, this one is prepared and aligned with it.
engine::Submission Odometry::Impl::submit(const Expectation& expected) {
  const engine::Slice surface_cloud = submap.next_cloud(front_end.capacity());
  try {
    engine::Recorder recorder = context.make_recorder();
    submap.record_update(recorder);
    front_end.record(recorder, surface_cloud, expected.motion);
    if (!submap.empty()) {
      aligner.record(recorder, expected.prediction, surface_cloud, front_end.counters(),
                     front_end.points(), submap);
    }
    return context.submit(std::move(recorder));
  } catch (...) {
    invalidate();
    throw;
  }
}

// The one wait of a sweep.
void Odometry::Impl::wait(Begun& sweep) {
  try {
    const auto start = std::chrono::steady_clock::now();
    sweep.submission.wait();
    sweep.result.wait_ms = milliseconds_since(start);
    sweep.result.stages = stage_times(sweep.submission);
  } catch (...) {
    invalidate();
    throw;
  }
}

// What is on the device is not known any more.
void Odometry::Impl::invalidate() {
  submap.invalidate();
  front_end.invalidate();
}

void Odometry::Impl::read_back(Begun& sweep) {
  SweepResult& result = sweep.result;
  result.deskewed = sweep.expected.motion.has_value();
  const gpu::SweepCounters counters = front_end.read_counters();
  result.valid_points = static_cast<int>(counters.valid_points);
  result.cloud_points = static_cast<int>(counters.cloud_points);
  result.lost_points = static_cast<int>(counters.input_failures + counters.surface_failures);
  if (sweep.aligns) {
    const gpu::VoxelMapCounters map_counters = aligner.read_map_counters();
    result.lost_points += static_cast<int>(submap.note_counters(map_counters));
    result.registration = aligner.read_result(result.cloud_points, submap);
    judge(sweep.expected.prediction, result);
  }
}

// What a search has found must be worth believing.
void Odometry::Impl::judge(const Prediction& prediction, SweepResult& result) {
  if (!is_usable(result.registration.status)) {
    return;
  }
  const StampedPose found{result.stamp, result.registration.T_target_source};
  if (const auto wrong = impossible_pose(found, motion.last(), config.recovery.max_speed)) {
    result.registration.status = RegistrationStatus::doubtful;
    result.doubt = *wrong;
  } else if (const auto doubt = usual_fit.doubt(result.registration, prediction)) {
    result.registration.status = RegistrationStatus::doubtful;
    result.doubt = *doubt;
  } else if (prediction.trusted) {
    usual_fit.add(result.registration);
  }
}

// The pose is the alignment's, the prediction where it failed, and with an inertial sensor what the
// sliding graph makes of them.
void Odometry::Impl::fuse(const Expectation& expected, SweepResult& result) {
  const bool aligned = is_usable(result.registration.status);
  const bool starts = submap.empty();
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
  if (result.inertial.nav) {
    result.T_map_lidar = inertial.T_map_lidar(*result.inertial.nav);
  }
}

// The policy of success, failure and recovery (docs/theory/odometry.md).
OdometryState Odometry::Impl::decide(SweepResult& result) {
  const auto points = static_cast<uint32_t>(result.cloud_points);
  const bool can_start = result.cloud_points >= config.registration.min_inliers;
  const bool aligned = is_usable(result.registration.status);
  const StampedPose pose{result.stamp, result.T_map_lidar};
  joined = false;

  if (aligned) {
    failures_in_a_row = 0;
    motion.update(pose, true);
    joined = submap.wants(pose.pose);
    if (joined) {
      submap.push(points, pose.pose);
    }
    return OdometryState::tracking;
  }
  const bool first = submap.empty();
  const bool gives_up = failures_in_a_row >= config.recovery.max_coasting;
  if (can_start && (first || gives_up)) {
    failures_in_a_row = 0;
    motion.restart(pose);
    submap.clear();
    usual_fit.forget();
    inertial.note_restart();
    submap.push(points, pose.pose);
    return first ? OdometryState::initializing : OdometryState::restarted;
  }
  ++failures_in_a_row;
  motion.update(pose, false);
  return OdometryState::coasting;
}

// How well the pose is known. A sweep that coasts, or restarts, is known as its prediction is; what
// a restart misses stays missed.
void Odometry::Impl::assess(const Expectation& expected, SweepResult& result) {
  Matrix6d local = result.inertial.lidar_covariance;
  const bool predicted = local.isZero() && result.state != OdometryState::initializing;
  if (predicted) {
    coasting += expected.prediction.sigma.cwiseAbs2().asDiagonal();
    local = coasting;
  } else {
    coasting.setZero();
  }
  result.uncertainty = drift.update(result.T_map_lidar, local, joined);
  if (result.state == OdometryState::restarted) {
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
