// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "adit/engine/context.hpp"
#include "adit/slam/fusion/inertial_tracker.hpp"
#include "adit/slam/odometry/aligner.hpp"
#include "adit/slam/odometry/motion_model.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/slam/odometry/rejection.hpp"
#include "adit/slam/odometry/submap.hpp"
#include "adit/slam/registration/front_end.hpp"

namespace adit {

inline double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// What is expected of a sweep before it is aligned.
struct Expectation {
  Prediction prediction;
  Eigen::Isometry3d steady = Eigen::Isometry3d::Identity();  ///< T_map_lidar at constant velocity
  std::optional<SweepMotion> motion;                         ///< to de-skew with
  bool measured = false;  ///< the prediction is by inertia or measured velocities, no extrapolation
  double inertial_ms = 0.0;             ///< host time of the inertial prediction
  std::optional<Silence> silence = {};  ///< no velocity and no trusted inertia leads here
};

/// A step between its halves.
struct PendingSweep {
  SweepResult result;  ///< what is known of it by now
  Expectation expected;
  engine::Submission submission;
  bool aligns = false;              ///< there is a submap
  double reach = 0.0;               ///< m, of the sweep
  std::optional<Sweep> sweep = {};  ///< kept of the first two, which may be done again
};

struct Odometry::Impl {
  Impl(engine::Context& context_, const Config& config_)
      : context(context_),
        config(config_),
        front_end(context_, config_.preprocess),
        submap(context_, config_),
        aligner(context_, config_.registration),
        inertial(config_.imu, config_.recording.imu_time_offset, config_.velocity) {}

  // odometry.cpp: what is expected, and what follows from an alignment.
  void use_lengths(const Config& derived);
  Expectation expect(const Sweep& sweep);
  Prediction possible_prediction(Nanoseconds stamp) const;
  void fuse(const Expectation& expected, SweepResult& result);
  void assess(const Expectation& expected, SweepResult& result);
  OdometryState decide(const Expectation& expected, SweepResult& result);
  bool is_keyframe(const SweepResult& result);
  std::optional<Silence> silence_before(Nanoseconds stamp, const Expectation& expected) const;
  void end_track_if_beyond_reach(const Sweep& sweep, Expectation& expected, SweepResult& result);
  std::optional<Eigen::Matrix3d> level_attitude(const Sweep& sweep) const;

  // odometry_alignment.cpp: the device's part, and whether its result is accepted.
  engine::Submission submit(const Expectation& expected);
  void wait(engine::Submission& submission, SweepResult& result);
  void align_on(SweepResult& result);
  void read_back(PendingSweep& sweep);
  void search_again(const Expectation& expected, SweepResult& result);
  void judge(const Expectation& expected, SweepResult& result);
  void begin_again(PendingSweep& second);
  SweepMotion motion_at(const Sweep& sweep, const Vector6d& twist) const;
  template <class Record>
  engine::Submission submitted(const Record& record);
  void invalidate();

  engine::Context& context;
  Config config;
  FrontEnd front_end;
  Submap submap;
  engine::Slice surface_cloud;  ///< this sweep's, in the submap's memory
  Aligner aligner;
  MotionModel motion;
  InertialTracker inertial;
  UsualFit usual_fit;
  DriftModel drift;
  UnmeasuredMotion unmeasured;
  Matrix6d coasting = Matrix6d::Zero();  ///< covariance of predictions in a row
  bool joined = false;                   ///< the last sweep's cloud, the submap
  std::optional<PendingSweep> pending;   ///< a sweep that is on the device
  bool hardly_moved = false;             ///< from the last sweep but one to the last
  bool at_rest = false;                  ///< the sensor was, when the last sweep was expected
  SweepRhythm rhythm;
  double reach = 0.0;        ///< m, of the last sweep that was aligned or started from
  bool track_ended = false;  ///< by a silence: the next sweep with enough points starts a new one
  int failures_in_a_row = 0;
  Nanoseconds map_began{0};
  std::optional<Sweep> first;  ///< began the first submap; until the second came
  std::optional<Eigen::Isometry3d> last_keyframe;  ///< T_map_lidar
};

}  // namespace adit
