// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <utility>

#include <gtest/gtest.h>

#include "adit/tests/slam/odometry_fixture.hpp"

namespace adit {
namespace {

using test::Drive;
using test::Error;
using test::make_drive;
using test::run_odometry;
using test::street_config;

class OdometryTest : public test::DeviceTest {};

TEST_F(OdometryTest, TheFirstSweepStartsTheMapAtTheIdentity) {
  const Drive drive = make_drive(1, 1.0);
  const SweepResult result = run_odometry(context(), drive.sweeps)[0];
  EXPECT_EQ(result.state, OdometryState::initializing);
  EXPECT_EQ(result.T_map_lidar.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_TRUE(result.keyframe);
  EXPECT_EQ(result.cloud.size(), static_cast<size_t>(result.cloud_points));
  EXPECT_EQ(result.raw_points, 32 * 480);
  EXPECT_GT(result.cloud_points, 4000);
  EXPECT_EQ(result.lost_points, 0);
  EXPECT_EQ(result.stamp, drive.sweeps[0].stamp);
  EXPECT_EQ(result.registration.inliers, 0);
  EXPECT_EQ(result.registration.hessian, Matrix6d::Zero());
}

/// Speed in m a sweep, turn in rad a sweep, sweeps.
struct Motion {
  double forward;
  double yaw;
  size_t sweeps;
};

class OdometryMotionTest : public OdometryTest, public testing::WithParamInterface<Motion> {};

TEST_P(OdometryMotionTest, TracksFromTheSecondSweepOn) {
  const Motion motion = GetParam();
  const Drive drive = make_drive(motion.sweeps, motion.forward, motion.yaw);
  const std::vector<SweepResult> results = run_odometry(context(), drive.sweeps);
  double way = 0.0;
  for (size_t i = 1; i < drive.size(); ++i) {
    way += motion.forward;
    EXPECT_EQ(results[i].state, OdometryState::tracking)
        << "sweep " << i << ": " << to_string(results[i].registration.status);
    EXPECT_EQ(results[i].lost_points, 0) << "sweep " << i;
    const Error error = drive.error(results[i], i);
    EXPECT_LE(error.translation, 0.03 + 0.004 * way) << "sweep " << i;
    EXPECT_LE(error.rotation, 0.010) << "sweep " << i;
  }
}

// The first motion is known to nobody: 3 m between two sweeps is 108 km/h at 10 Hz.
INSTANTIATE_TEST_SUITE_P(Street, OdometryMotionTest,
                         testing::Values(Motion{0.0, 0.0, 8}, Motion{0.5, 0.01, 24},
                                         Motion{1.0, -0.005, 24}, Motion{2.0, 0.0, 24},
                                         Motion{3.0, 0.0, 16}, Motion{0.0, 0.15, 16}));

// More clouds than the submap holds: their moments leave it, too.
TEST_F(OdometryTest, TracksByNdtAsWell) {
  Config config = street_config();
  config.registration.method = "ndt";
  config.submap.l = 12;
  const Drive drive = make_drive(30, 0.7, 0.008);
  Odometry odometry(context(), config);
  std::vector<SweepResult> results{odometry.step(drive.sweeps[0])};
  for (size_t i = 1; i < drive.size(); ++i) {
    results.push_back(odometry.step(drive.sweeps[i]));
    EXPECT_EQ(results[i].state, OdometryState::tracking)
        << "sweep " << i << ": " << to_string(results[i].registration.status);
    EXPECT_LT(results[i].registration.cost, 0.0) << "the score, negative";
    const Error error = drive.error(results[i], i);
    EXPECT_LE(error.translation, 0.03 + 0.004 * 0.7 * static_cast<double>(i)) << "sweep " << i;
    EXPECT_LE(error.rotation, 0.010) << "sweep " << i;
  }
  // It is another method: the same drive ends elsewhere by more than rounding.
  config.registration.method = "vgicp";
  const SweepResult other = run_odometry(context(), drive.sweeps, config).back();
  EXPECT_GT((other.T_map_lidar.translation() - results.back().T_map_lidar.translation()).norm(),
            1e-5);
}

TEST_F(OdometryTest, TheSameSweepAgainIsNoMotion) {
  const Drive drive = make_drive(6, 0.4);
  std::vector<Sweep> sweeps = drive.sweeps;
  sweeps.push_back(sweeps.back());  // the same stamp
  sweeps.push_back(sweeps.back());
  sweeps.back().stamp += std::chrono::milliseconds(100);  // a later one: the sensor stopped
  const std::vector<SweepResult> results = run_odometry(context(), sweeps);
  for (const size_t i : {6U, 7U}) {
    EXPECT_EQ(results[i].state, OdometryState::tracking);
    const Eigen::Isometry3d moved = results[5].T_map_lidar.inverse() * results[i].T_map_lidar;
    EXPECT_LE(moved.translation().norm(), 0.02) << "sweep " << i;
    EXPECT_LE(rotation_angle(moved.linear()), 2e-3) << "sweep " << i;
  }
}

TEST_F(OdometryTest, KeyframesAreAsFarApartAsTheConfigurationSays) {
  Config config = street_config();
  config.keyframe.delta_trans = 1.0;
  config.keyframe.delta_rot = 0.35;
  const auto keyframes = [&](double forward, double yaw) {
    std::vector<size_t> found;
    const std::vector<SweepResult> results =
        run_odometry(context(), make_drive(12, forward, yaw).sweeps, config);
    for (size_t i = 0; i < results.size(); ++i) {
      if (results[i].keyframe) {
        found.push_back(i);
        EXPECT_EQ(results[i].cloud.size(), static_cast<size_t>(results[i].cloud_points));
      }
    }
    return found;
  };
  EXPECT_EQ(keyframes(0.4, 0.0), (std::vector<size_t>{0, 3, 6, 9}));  // 1.2 m
  EXPECT_EQ(keyframes(1.5, 0.0), (std::vector<size_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(keyframes(0.0, 0.1), (std::vector<size_t>{0, 4, 8}));  // 0.4 rad
  EXPECT_EQ(keyframes(0.0, 0.0), (std::vector<size_t>{0}));
}

TEST_F(OdometryTest, TheHessianSeesAllSixDirectionsOfAStreet) {
  const std::vector<SweepResult> results = run_odometry(context(), make_drive(4, 1.0).sweeps);
  for (size_t i = 1; i < results.size(); ++i) {
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(results[i].registration.hessian);
    EXPECT_GT(eigen.eigenvalues()(0), 1000.0) << "1/m^2 or 1/rad^2, sweep " << i;
  }
}

/// All bytes of a result but its times.
std::vector<double> figures_of(const SweepResult& result) {
  const RegistrationResult& r = result.registration;
  std::vector<double> figures(result.T_map_lidar.data(), result.T_map_lidar.data() + 16);
  figures.insert(figures.end(), r.T_target_source.data(), r.T_target_source.data() + 16);
  figures.insert(figures.end(), r.hessian.data(), r.hessian.data() + 36);
  figures.insert(figures.end(), r.gradient.data(), r.gradient.data() + 6);
  const auto add = [&](auto... values) { (figures.push_back(static_cast<double>(values)), ...); };
  add(r.cost, r.residual_rms, r.overlap, r.inliers, r.source_points, r.iterations,
      static_cast<int>(r.status));
  add(static_cast<int>(result.state), result.keyframe, result.raw_points, result.valid_points,
      result.cloud_points, result.lost_points, result.stamp.count());
  for (const Point& point : result.cloud) {
    add(point.x, point.y, point.z, point.intensity);
  }
  return figures;
}

TEST_F(OdometryTest, TwoOdometriesGiveTheSameBytes) {
  const Drive drive = make_drive(14, 1.5, 0.01);
  Config config = street_config();
  config.submap.l = 4;  // clouds leave the submap, too
  const std::vector<SweepResult> a = run_odometry(context(), drive.sweeps, config);
  const std::vector<SweepResult> b = run_odometry(context(), drive.sweeps, config);
  for (size_t i = 0; i < drive.size(); ++i) {
    const std::vector<double> left = figures_of(a[i]);
    const std::vector<double> right = figures_of(b[i]);
    ASSERT_EQ(left.size(), right.size());
    EXPECT_EQ(std::memcmp(left.data(), right.data(), left.size() * sizeof(double)), 0)
        << "sweep " << i;
  }
}

TEST_F(OdometryTest, TwoOdometriesOnOneContextDoNotMeet) {
  const Drive one = make_drive(6, 1.0, 0.0, 1);
  const Drive two = make_drive(6, 2.0, 0.0, 2);
  const std::vector<SweepResult> alone = run_odometry(context(), one.sweeps);
  Odometry first(context(), street_config());
  Odometry second(context(), street_config());
  for (size_t i = 0; i < one.size(); ++i) {
    const SweepResult result = first.step(one.sweeps[i]);
    second.step(two.sweeps[i]);
    EXPECT_EQ(figures_of(result), figures_of(alone[i])) << "sweep " << i;
  }
}

TEST_F(OdometryTest, TheOrderOfPointsChangesNothingThatMatters) {
  // The down-sampled cloud keeps the order of the sweep, so sums of floats differ in their last
  // bits, and no more.
  Drive drive = make_drive(6, 1.0);
  const std::vector<SweepResult> as_scanned = run_odometry(context(), drive.sweeps);
  for (Sweep& sweep : drive.sweeps) {
    std::reverse(sweep.points.begin(), sweep.points.end());
  }
  const std::vector<SweepResult> backwards = run_odometry(context(), drive.sweeps);
  for (size_t i = 0; i < drive.size(); ++i) {
    EXPECT_EQ(as_scanned[i].cloud_points, backwards[i].cloud_points);
    const Eigen::Isometry3d off = as_scanned[i].T_map_lidar.inverse() * backwards[i].T_map_lidar;
    EXPECT_LE(off.translation().norm(), 1e-3) << "sweep " << i;
  }
}

TEST_F(OdometryTest, StagesAreTimedOnADeviceThatProfiles) {
  const std::vector<SweepResult> results = run_odometry(context(), make_drive(4, 1.0).sweeps);
  double sum = 0.0;
  bool aligned = false;
  for (const StageTime& stage : results[3].stages) {
    EXPECT_GE(stage.device_ms, 0.0) << stage.stage;
    sum += stage.device_ms;
    aligned = aligned || stage.stage == "alignment";
  }
  EXPECT_TRUE(aligned);
  EXPECT_GT(sum, 0.0);
  // Not the wait alone: on a busy machine the device may be done before the host begins to wait.
  EXPECT_LE(sum, 1.05 * (results[3].host_ms + results[3].wait_ms) + 1.0)
      << "the device worked longer than the step took";
}

}  // namespace
}  // namespace adit
