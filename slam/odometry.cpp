// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/odometry.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/context.hpp"
#include "slam/aligner.hpp"
#include "slam/doubt.hpp"
#include "slam/front_end.hpp"
#include "slam/inertial_tracker.hpp"
#include "slam/motion_model.hpp"
#include "slam/odometry/possible_pose.hpp"
#include "slam/submap.hpp"

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
  void run_on_device(const Expectation& expected, SweepResult& result);
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
  int failures_in_a_row = 0;
  std::optional<Eigen::Isometry3d> last_keyframe;  ///< T_map_lidar
};

Odometry::Odometry(engine::Context& context, const Config& config)
    : impl_(std::make_unique<Impl>(context, config)) {}
Odometry::~Odometry() = default;

SweepResult Odometry::step(const Sweep& sweep) {
  const auto start = std::chrono::steady_clock::now();
  SweepResult result;
  result.stamp = sweep.stamp;
  result.raw_points = static_cast<int>(sweep.points.size());
  if (!impl_->front_end.knows_beam_spacing()) {
    impl_->front_end.measure_beam_spacing(sweep.points);
  }
  impl_->front_end.upload(sweep);
  const Expectation expected = impl_->expect(sweep);
  impl_->run_on_device(expected, result);
  impl_->fuse(expected, result);
  result.state = impl_->decide(result);
  impl_->assess(expected, result);
  if (impl_->is_keyframe(result)) {
    result.keyframe = true;
    result.cloud = impl_->front_end.read_cloud();
  }
  result.host_ms = milliseconds_since(start) - result.wait_ms;
  return result;
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
  const double duration = config.preprocess.deskew == 0 ? 0.0 : duration_of(sweep);
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
  if (config.preprocess.deskew == 0 || !front_end.has_times()) {
    expected.motion.reset();
  }
  return expected;
}

// One submission, one wait: the last sweep joins the submap, this one is prepared and aligned with
// it.
void Odometry::Impl::run_on_device(const Expectation& expected, SweepResult& result) {
  const engine::Slice surface_cloud = submap.next_cloud(front_end.capacity());
  const bool aligns = !submap.empty();
  try {
    engine::Recorder recorder = context.make_recorder();
    submap.record_update(recorder);
    front_end.record(recorder, surface_cloud, expected.motion);
    if (aligns) {
      aligner.record(recorder, expected.prediction, surface_cloud, front_end.counters(),
                     front_end.points(), submap);
    }
    engine::Submission submission = context.submit(std::move(recorder));
    const auto start = std::chrono::steady_clock::now();
    submission.wait();
    result.wait_ms = milliseconds_since(start);
    result.stages = stage_times(submission);
  } catch (...) {
    submap.invalidate();
    front_end.invalidate();
    throw;
  }
  result.deskewed = expected.motion.has_value();
  const gpu::SweepCounters counters = front_end.read_counters();
  result.valid_points = static_cast<int>(counters.valid_points);
  result.cloud_points = static_cast<int>(counters.cloud_points);
  result.lost_points = static_cast<int>(counters.input_failures + counters.surface_failures);
  if (aligns) {
    const gpu::VoxelMapCounters map_counters = aligner.read_map_counters();
    result.lost_points += static_cast<int>(submap.note_counters(map_counters));
    result.registration = aligner.read_result(result.cloud_points, submap);
    judge(expected.prediction, result);
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
