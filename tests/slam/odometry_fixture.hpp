// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A synthetic street for tests of the odometry, and how far a result is from the truth.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit::test {

struct Error {
  double translation = 0.0;  ///< m
  double rotation = 0.0;     ///< rad
};

/// Sweeps with the truth.
struct Drive {
  std::vector<StampedPose> truth;  ///< T_world_lidar
  std::vector<Sweep> sweeps;

  size_t size() const { return sweeps.size(); }
  /// T_map_lidar: the map frame is the lidar frame of the first sweep.
  Eigen::Isometry3d T_map_lidar(size_t i) const { return truth[0].pose.inverse() * truth[i].pose; }
  Error error(const SweepResult& result, size_t i) const {
    const Eigen::Isometry3d off = T_map_lidar(i).inverse() * result.T_map_lidar;
    return {off.translation().norm(), rotation_angle(off.linear())};
  }
};

/// Points anywhere in a cube around the sensor.
inline Sweep noise(Nanoseconds stamp, size_t count = 15'000, double radius = 30.0) {
  Random random(static_cast<uint64_t>(stamp.count()) + 5);
  Sweep sweep;
  sweep.stamp = stamp;
  for (size_t i = 0; i < count; ++i) {
    const auto coordinate = [&] { return static_cast<float>(random.uniform(-radius, radius)); };
    sweep.points.push_back({coordinate(), coordinate(), coordinate(), 1.0F});
  }
  return sweep;
}

/// A constant motion along a street: m and rad between sweeps.
inline Drive make_drive(size_t count, double forward, double yaw = 0.0, uint64_t seed = 1) {
  const World world = make_street(100.0, seed);
  Drive drive;
  drive.truth = steady_drive(count, twist(forward, yaw));
  drive.sweeps = scan_all(world, drive.truth, Lidar{});
  return drive;
}

inline Config street_config() {
  Config config;
  config.preprocess.beam_spacing = Lidar{}.beam_spacing();
  return config;
}

/// What holds for every result, whatever the sweep was.
inline void expect_sane(const SweepResult& result) {
  EXPECT_TRUE(result.T_map_lidar.matrix().allFinite());
  const Eigen::Matrix3d r = result.T_map_lidar.linear();
  EXPECT_LE((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  const RegistrationResult& registration = result.registration;
  EXPECT_TRUE(registration.T_target_source.matrix().allFinite());
  EXPECT_EQ(registration.hessian, registration.hessian.transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(registration.hessian);
  EXPECT_GE(eigen.eigenvalues()(0), -1e-6 * std::max(1.0, eigen.eigenvalues()(5)));
  EXPECT_GE(registration.cost, 0.0);
  EXPECT_GE(registration.overlap, 0.0);
  EXPECT_LE(registration.overlap, 1.0);
  EXPECT_LE(registration.inliers, result.cloud_points);
  EXPECT_LE(result.cloud_points, result.valid_points);
  EXPECT_LE(result.valid_points, result.raw_points);
  const bool aligned = is_usable(registration.status);
  EXPECT_EQ(result.state == OdometryState::tracking, aligned);
  EXPECT_EQ(result.cloud.empty(), !result.keyframe);
  if (result.state == OdometryState::coasting) {
    EXPECT_FALSE(result.keyframe);
  }
}

inline std::vector<SweepResult> run_odometry(engine::Context& context,
                                             const std::vector<Sweep>& sweeps,
                                             const Config& config = street_config()) {
  Odometry odometry(context, config);
  std::vector<SweepResult> results;
  for (const Sweep& sweep : sweeps) {
    results.push_back(odometry.step(sweep));
    SCOPED_TRACE("sweep " + std::to_string(results.size() - 1));
    expect_sane(results.back());
  }
  return results;
}

}  // namespace adit::test
