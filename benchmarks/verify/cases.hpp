// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The one list of inputs: tests verify every kernel on all of them, benchmarks verify and then time
// the streets. All are made from seeds: the same points on every machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adit/benchmarks/reference/vgicp.hpp"
#include "adit/engine/kernels/deskew.hpp"
#include "adit/engine/kernels/preprocess.hpp"
#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/inertial/sweep_motion.hpp"

namespace adit::test {

/// A sweep and how to preprocess it.
struct SweepCase {
  std::string name;
  engine::PreprocessSettings settings;
  std::vector<Point> raw;
};

/// A spinning lidar in a street, `points` returns and no-returns in all.
SweepCase street_sweep(int points);

/// Rooms, rings, random clouds, long ranges, borders of cells and everything degenerate; the
/// largest has 30 000 points.
std::vector<SweepCase> sweep_cases();

/// Two sweeps of a street and their true relative pose.
struct AlignmentCase {
  std::string name;
  engine::PreprocessSettings preprocess;
  std::vector<Point> target;
  std::vector<Point> source;
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  double voxel_size = 0.0;  ///< m
  reference::AlignmentSettings settings;
};

/// The sweeps are about `points` long; the second was taken 0.6 m farther on and turned by 1.5
/// degrees.
AlignmentCase street_alignment(int points);

/// What sweeps are de-skewed by: driving at 20 m/s into a bend, and a hand that turns at 3 rad/s.
std::vector<SweepMotion> sweep_motions();

/// Times of as many points, evenly from the motion's first to its last.
std::vector<float> spread_times(size_t count, const SweepMotion& motion);

/// Ranges of c_min to 100 m.
engine::DeskewSettings deskew_settings(const SweepMotion& motion, double c_min);

/// Single clouds, for tests of one property.
std::vector<Point> room(int points, uint64_t seed, double noise = 0.01);
std::vector<Point> random_points(int points, uint64_t seed, const Eigen::Vector3d& low,
                                 const Eigen::Vector3d& high);

}  // namespace adit::test
