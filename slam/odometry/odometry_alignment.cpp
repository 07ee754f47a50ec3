// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The device's part of a step, and whether its result is accepted.
#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "adit/slam/inertial/sweep_motion.hpp"
#include "adit/slam/odometry/odometry_impl.hpp"
#include "adit/slam/odometry/possible_pose.hpp"
#include "adit/slam/odometry/search_places.hpp"

namespace adit {
namespace {

// What a search finds must match so many times as many points as what it replaces.
constexpr double kAgainstPrediction = 1.1;
// Farther than this from an inertial prediction, in its standard deviations, contradicts it.
constexpr double kInertialSigmas = 5.0;
// What contradicts it must match so many times as many points.
constexpr double kAgainstInertia = 1.5;
// A sweep in whose time the sensor moved less than this need not be de-skewed, m.
constexpr double kNoticeable = 0.01;
constexpr double kNoticeableTurn = 0.005;  // rad
// What is done again is done again until it stays within this. Each round leaves half of the
// error: a sweep that is bent by a wrong velocity is off by what that makes of half its time.
constexpr double kSettled = 0.001;       // m
constexpr double kSettledTurn = 0.0005;  // rad
constexpr int kMostRounds = 8;
// What a velocity during the first sweep differs by from what the step to the second says: people
// and cars, m/s, and rad/s where readings do not cover that sweep, or do.
constexpr double kUnsteady = 0.25;
constexpr double kUnsteadyTurn = 0.15;
constexpr double kUnsteadyReadings = 0.02;

/// Standard deviations of the velocity, m/s and rad/s.
Vector6d unsteadiness(bool covered) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kUnsteady),
      Eigen::Vector3d::Constant(covered ? kUnsteadyReadings : kUnsteadyTurn);
  return sigma;
}

// The times of scopes outside any other, added up by name.
void add_stages(const engine::Submission& submission, std::vector<StageTime>& stages) {
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
}

}  // namespace

// What is on the device after a failure is not known any more.
void Odometry::Impl::invalidate() {
  submap.invalidate();
  front_end.invalidate();
}

template <class Record>
engine::Submission Odometry::Impl::submitted(const Record& record) {
  try {
    engine::Recorder recorder = context.make_recorder();
    record(recorder);
    return context.submit(std::move(recorder));
  } catch (...) {
    invalidate();
    throw;
  }
}

void Odometry::Impl::wait(engine::Submission& submission, SweepResult& result) {
  try {
    const auto start = std::chrono::steady_clock::now();
    submission.wait();
    result.wait_ms += milliseconds_since(start);
    result.device_work += submission.recorded();
    add_stages(submission, result.stages);
  } catch (...) {
    invalidate();
    throw;
  }
}

// An alignment that goes on for longer than the last ones did.
void Odometry::Impl::align_on(SweepResult& result) {
  while (aligner.unfinished()) {
    engine::Submission submission = submitted(
        [&](engine::Recorder& recorder) { aligner.record_rest(recorder, surface_cloud, submap); });
    wait(submission, result);
  }
}

// The last sweep joins the submap, this one is prepared and aligned with it.
engine::Submission Odometry::Impl::submit(const Expectation& expected) {
  surface_cloud = submap.next_cloud(front_end.capacity());
  return submitted([&](engine::Recorder& recorder) {
    submap.record_update(recorder);
    front_end.record(recorder, surface_cloud, expected.motion);
    if (!submap.empty()) {
      aligner.record(recorder, expected.prediction,
                     places_to_search(expected.prediction, expected.silence), surface_cloud,
                     front_end.counters(), front_end.points(), submap);
    }
  });
}

void Odometry::Impl::read_back(PendingSweep& sweep) {
  SweepResult& result = sweep.result;
  if (sweep.expected.motion) {
    result.deskewed = true;
    result.deskewed_turn = mean_turn(*sweep.expected.motion);
  }
  const gpu::SweepCounters counters = front_end.read_counters();
  result.valid_points = static_cast<int>(counters.valid_points);
  result.cloud_points = static_cast<int>(counters.cloud_points);
  result.lost_points = static_cast<int>(counters.input_failures + counters.surface_failures);
  if (sweep.aligns) {
    const gpu::VoxelMapCounters map_counters = aligner.read_map_counters();
    const SubmapLoss loss = submap.note_counters(map_counters);
    result.lost_points += static_cast<int>(loss.points);
    result.crowded_voxels = static_cast<int>(loss.crowded_voxels);
    result.registration = aligner.read_result(result.cloud_points, submap);
  }
}

// An alignment from a trusted prediction that falls short of what is usual may have ended in the
// wrong place: the sweep is aligned again, from all the ways that the sensor may have gone.
void Odometry::Impl::search_again(const Expectation& expected, SweepResult& result) {
  const bool can = !submap.empty() && result.cloud_points >= config.registration.min_inliers;
  if (!can || !expected.prediction.trusted || !usual_fit.falls_short(result.registration)) {
    return;
  }
  // Inertia knows better than what fits best: rings on the ground fit best where they were.
  const bool failed = !is_usable(result.registration.status);
  if (expected.measured && !failed) {
    return;
  }
  Prediction untrusted = expected.prediction;
  untrusted.trusted = false;
  const auto places = places_after_rejection({.predicted = expected.prediction.T_map_lidar,
                                              .steady = expected.steady,
                                              .at_rest = motion.last()->pose});
  engine::Submission submission = submitted([&](engine::Recorder& recorder) {
    aligner.record(recorder, untrusted, places, surface_cloud, front_end.counters(),
                   front_end.points(), submap);
  });
  wait(submission, result);
  align_on(result);
  const RegistrationResult found = aligner.read_result(result.cloud_points, submap);
  const bool against = expected.measured && !is_within(found, expected.prediction, kInertialSigmas);
  const double needed = against ? kAgainstInertia : kAgainstPrediction;
  const bool clearly = found.inliers > needed * result.registration.inliers;
  // What falls short by its residual may match nearly as many points as the right place.
  const bool mends = found.inliers > result.registration.inliers && !usual_fit.falls_short(found);
  if (is_usable(found.status) && (clearly || ((failed || mends) && !against))) {
    result.registration = found;
  }
  result.searched = true;
}

// Gates what was found. An inertial prediction weighs the alignment itself: the
// graph gives what contradicts it that much less weight.
void Odometry::Impl::judge(const Expectation& expected, SweepResult& result) {
  if (!is_usable(result.registration.status)) {
    return;
  }
  const StampedPose found{result.stamp, result.registration.T_target_source};
  std::optional<Rejection> rejection =
      impossible_pose(found, motion.last(), config.recovery.max_speed);
  const Prediction& prediction = expected.prediction;
  if (!rejection && expected.silence) {
    rejection = usual_fit.rejection_after(*expected.silence, result.registration,
                                          motion.last()->pose.inverse() * found.pose);
  }
  const bool weighed = prediction.trusted && (!result.searched || expected.measured);
  if (!rejection && !weighed && !expected.silence) {
    rejection = usual_fit.rejection(result.registration, prediction);
  }
  if (rejection) {
    result.registration.status = RegistrationStatus::doubtful;
    result.rejection = rejection;
  } else if (prediction.trusted) {
    usual_fit.add(result.registration);
  }
}

SweepMotion Odometry::Impl::motion_at(const Sweep& sweep, const Vector6d& twist) const {
  const double duration = duration_of(sweep);
  return inertial.turning_motion(sweep.stamp, duration, twist.head<3>())
      .value_or(steady_motion(twist, 0.0, duration));
}

// The first sweep of a sensor that is moving already was taken as it came, since its velocity
// was unknown. With the second sweep's alignment it is known: both are done again, de-skewed, until
// the velocity stays: an alignment of sweeps that are bent otherwise is off.
void Odometry::Impl::begin_again(PendingSweep& second) {
  // A sweep with too few points is no second one: the next may be.
  if (!first || !second.aligns || second.result.cloud_points < config.registration.min_inliers) {
    return;
  }
  const Sweep begins = *std::exchange(first, std::nullopt);
  const Sweep& sweep = *second.sweep;
  SweepResult& result = second.result;
  const double elapsed = seconds(sweep.stamp - motion.last()->stamp);
  if (!is_usable(result.registration.status) || !config.preprocess.deskew ||
      !front_end.has_times() || !(elapsed > 0.0)) {
    return;
  }
  const Eigen::Isometry3d T_map_first = motion.last()->pose;
  const double duration = duration_of(sweep);
  const auto turn = inertial.turn(sweep.stamp, sweep.stamp + nanoseconds(duration));
  Vector6d used = Vector6d::Zero();
  for (int round = 0; round < kMostRounds && is_usable(result.registration.status); ++round) {
    Vector6d twist = se3_log(T_map_first.inverse() * result.registration.T_target_source) / elapsed;
    // Recordings often begin with a sweep, and readings come later: how it turned is the best
    // guess until a step of sweeps that are hardly bent is known.
    if (round == 0 && turn) {
      twist.tail<3>() = so3_log(*turn) / duration;
    }
    const Vector6d change = duration * (twist - used);
    if (change.head<3>().norm() < (round == 0 ? kNoticeable : kSettled) &&
        change.tail<3>().norm() < (round == 0 ? kNoticeableTurn : kSettledTurn)) {
      return;
    }
    if (round == 0) {
      const bool covered =
          inertial.turn(begins.stamp, begins.stamp + nanoseconds(duration)).has_value();
      drift.begin_vaguely(0.5 * duration * unsteadiness(covered));
    }
    used = twist;
    submap.clear();
    front_end.upload(begins);
    surface_cloud = submap.next_cloud(front_end.capacity());
    engine::Submission prepared = submitted([&](engine::Recorder& recorder) {
      front_end.record(recorder, surface_cloud, motion_at(begins, twist));
    });
    wait(prepared, result);
    submap.push(front_end.read_counters().cloud_points, T_map_first);

    front_end.upload(sweep);
    second.expected.prediction.T_map_lidar = result.registration.T_target_source;
    second.expected.prediction.trusted = true;
    second.expected.motion = motion_at(sweep, twist);
    engine::Submission aligned = submit(second.expected);
    wait(aligned, result);
    align_on(result);
    read_back(second);
  }
}

}  // namespace adit
