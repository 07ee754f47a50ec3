// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The odometry with sweeps that are taken while the sensor moves, with and without its IMU.
#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

#include "adit/slam/odometry/odometry.hpp"
#include "adit/tests/slam/odometry_fixture.hpp"
#include "adit/tests/support/moving_drive.hpp"

namespace adit {
namespace {

using test::MovingDrive;

class InertialOdometry : public test::DeviceTest {};

Config walking_config() {
  Config config = test::street_config();
  config.imu.T_imu_lidar = numbers_of(test::turned_mounting());
  return config;
}

std::vector<SweepResult> place_all(engine::Context& context, const MovingDrive& drive,
                                   const Config& config) {
  Odometry odometry(context, config);
  std::vector<SweepResult> results;
  size_t fed = 0;
  for (const Sweep& sweep : drive.sweeps) {
    const Nanoseconds end = sweep.stamp + std::chrono::milliseconds(105);
    for (; fed < drive.readings.size() && drive.readings[fed].stamp <= end; ++fed) {
      odometry.add(drive.readings[fed]);
    }
    results.push_back(odometry.step(sweep));
    test::expect_sane(results.back());
  }
  return results;
}

/// Relative to the pose of sweep kStarted: by then the inertial sensor has been started, in motion
/// as it is, and sweeps from before that have left the submap.
constexpr size_t kStarted = 25;
struct Errors {
  double rms = 0.0;
  double largest = 0.0;
  double turn = 0.0;  ///< rad, largest
};

Errors errors_of(const std::vector<SweepResult>& results, const MovingDrive& drive) {
  Errors errors;
  for (size_t i = kStarted; i < results.size(); ++i) {
    const Eigen::Isometry3d estimate =
        results[kStarted].T_map_lidar.inverse() * results[i].T_map_lidar;
    const Eigen::Isometry3d truth = drive.truth[kStarted].pose.inverse() * drive.truth[i].pose;
    const Eigen::Isometry3d off = truth.inverse() * estimate;
    errors.rms += off.translation().squaredNorm() / static_cast<double>(results.size() - kStarted);
    errors.largest = std::max(errors.largest, off.translation().norm());
    errors.turn = std::max(errors.turn, rotation_angle(off.linear()));
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

std::string text_of(const Errors& e) {
  return std::to_string(e.rms) + " m rms, " + std::to_string(e.largest) + " m at most, " +
         std::to_string(e.turn) + " rad at most";
}

size_t failures(const std::vector<SweepResult>& results) {
  return static_cast<size_t>(std::ranges::count_if(results, [](const SweepResult& result) {
    return result.state == OdometryState::coasting || result.state == OdometryState::restarted;
  }));
}

TEST_F(InertialOdometry, ASwingingSensorIsFollowedToCentimetres) {
  const MovingDrive drive = test::moving_drive(test::make_street(30.0), test::walk(1.5, 0.3),
                                               test::turned_mounting(), test::Lidar{}, 60);
  Config config = walking_config();
  const auto with_imu = place_all(context(), drive, config);
  config.imu.use = false;
  const auto steady = place_all(context(), drive, config);
  const Errors a = errors_of(with_imu, drive);
  RecordProperty("imu", text_of(a));
  RecordProperty("constant_velocity", text_of(errors_of(steady, drive)));
  EXPECT_EQ(failures(with_imu), 0U);
  EXPECT_EQ(with_imu.back().inertial.state, InertialState::fused);
  EXPECT_TRUE(std::ranges::none_of(with_imu, &SweepResult::rested));
  EXPECT_TRUE(with_imu.back().deskewed);
  EXPECT_LT(2.0 * a.rms, errors_of(steady, drive).rms);
  EXPECT_LE(a.rms, 0.05);
  EXPECT_LE(a.turn, 0.01);
}

TEST_F(InertialOdometry, ASteadyDriveIsDeskewedAtConstantVelocityAsWell) {
  const test::WavyMotion bend{.position = {{{0.0, 0.0, 0.0, 8.0}, {0.0, 0.0, 0.0, 0.5}, {}}},
                              .angles = {{{}, {}, {0.0, 0.0, 0.0, 0.2}}}};
  const MovingDrive drive =
      test::moving_drive(test::make_street(60.0), bend, test::turned_mounting(), test::Lidar{}, 40);
  Config config = walking_config();
  config.imu.use = false;
  const auto moved = place_all(context(), drive, config);
  config.preprocess.deskew = false;
  const auto skewed = place_all(context(), drive, config);
  EXPECT_TRUE(moved.back().deskewed);
  EXPECT_FALSE(skewed.back().deskewed);
  RecordProperty("deskewed", text_of(errors_of(moved, drive)));
  RecordProperty("not_deskewed", text_of(errors_of(skewed, drive)));
  EXPECT_EQ(failures(moved), 0U);
  EXPECT_LT(errors_of(moved, drive).rms, errors_of(skewed, drive).rms);
}

TEST_F(InertialOdometry, TheMapIsLevel) {
  const test::WavyMotion glide{
      .position = {{{0.0, 0.0, 0.0, 1.0}, {}, {}}},
      .angles = {{{0.05, 0.3, 0.9, 0.0}, {0.04, 0.4, 1.3, 0.0}, {0.2, 0.2, 0.0, 0.0}}}};
  const MovingDrive drive = test::moving_drive(test::make_street(30.0), glide,
                                               test::turned_mounting(), test::Lidar{}, 20);
  const auto results = place_all(context(), drive, walking_config());
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  // Up in the lidar's frame, by the estimate and by the truth: off by what the accelerometer's bias
  // tilts it.
  EXPECT_LE(test::angle_between(results[0].T_map_lidar.linear().transpose() * up,
                                drive.truth[0].pose.linear().transpose() * up),
            0.02);
  const SweepResult& last = results.back();
  ASSERT_EQ(last.inertial.state, InertialState::fused);
  EXPECT_LE(test::angle_between(last.T_map_lidar.linear().transpose() * -last.inertial.gravity_map,
                                drive.truth.back().pose.linear().transpose() * up),
            0.05);
}

// Open ground holds no heading: for all that matches say, the sensor may turn. Then the readings
// tell that it was at rest.
TEST_F(InertialOdometry, AStartAtRestTakesBackWhatMayHaveMoved) {
  test::WavyMotion motion = test::walk(1.5, 0.3);
  motion.rest = 10.0;
  const MovingDrive drive =
      test::moving_drive(test::World{}, motion, test::turned_mounting(), test::Lidar{}, 20);
  const std::vector<SweepResult> results = place_all(context(), drive, walking_config());
  const auto rested = std::ranges::find_if(results, &SweepResult::rested);
  ASSERT_NE(rested, results.end());
  EXPECT_EQ(std::ranges::count_if(results, &SweepResult::rested), 1);
  EXPECT_EQ(rested->inertial.state, InertialState::fused);
  const auto heading = [](const SweepResult& result) {
    return std::sqrt(result.uncertainty.drift(5, 5));
  };
  EXPECT_GT(heading(*(rested - 1)), 0.05);
  EXPECT_LT(heading(*rested), 0.01);
  EXPECT_LT(heading(results.back()), 0.02);
}

// A hand that swings the sensor by two radians a second.
TEST_F(InertialOdometry, FastSwingsAreNotLost) {
  const MovingDrive drive = test::moving_drive(test::make_street(30.0), test::walk(1.2, 0.5),
                                               test::turned_mounting(), test::Lidar{}, 60);
  Config config = walking_config();
  const auto with_imu = place_all(context(), drive, config);
  config.imu.use = false;
  const auto steady = place_all(context(), drive, config);
  RecordProperty("imu", text_of(errors_of(with_imu, drive)));
  RecordProperty("constant_velocity", text_of(errors_of(steady, drive)) + ", " +
                                          std::to_string(failures(steady)) + " failures");
  EXPECT_EQ(failures(with_imu), 0U);
  EXPECT_LE(errors_of(with_imu, drive).rms, 0.05);
}

TEST_F(InertialOdometry, SweepsWithoutPointsAreBridgedByInertia) {
  MovingDrive drive = test::moving_drive(test::make_street(30.0), test::walk(1.5, 0.3),
                                         test::turned_mounting(), test::Lidar{}, 45);
  for (size_t i = 30; i < 35; ++i) {
    drive.sweeps[i].points.assign(drive.sweeps[i].points.size(), {});
  }
  const auto results = place_all(context(), drive, walking_config());
  for (size_t i = 30; i < 35; ++i) {
    EXPECT_EQ(results[i].state, OdometryState::coasting) << i;
    EXPECT_EQ(results[i].inertial.state, InertialState::fused) << i;
  }
  for (size_t i = 36; i < 45; ++i) {
    EXPECT_EQ(results[i].state, OdometryState::tracking) << i;
  }
  EXPECT_LE(errors_of(results, drive).largest, 0.1);
}

TEST_F(InertialOdometry, ASubmapThatBeginsAnewIsTiedToTheOldOneByInertia) {
  MovingDrive drive = test::moving_drive(test::make_street(30.0), test::walk(1.5, 0.3),
                                         test::turned_mounting(), test::Lidar{}, 50);
  for (size_t i = 30; i < 36; ++i) {  // as many as are too many, of what is nowhere
    drive.sweeps[i] = test::noise(drive.sweeps[i].stamp);
  }
  const auto results = place_all(context(), drive, walking_config());
  EXPECT_EQ(std::ranges::count(results, OdometryState::restarted, &SweepResult::state), 0);
  EXPECT_EQ(std::ranges::find(results, true, &SweepResult::renewed) - results.begin(), 35);
  EXPECT_EQ(results[35].state, OdometryState::coasting);
  // What was scattered was a bad place to begin from, and is left in the same way.
  for (size_t i = 42; i < results.size(); ++i) {
    EXPECT_EQ(results[i].state, OdometryState::tracking) << i;
  }
  // What inertia did not know of the way stays unknown: a new submap knows no better.
  const auto variance = [](const Matrix6d& covariance) {
    return covariance.diagonal().head<3>().sum();
  };
  EXPECT_TRUE(results[35].uncertainty.local.isZero());
  EXPECT_GT(
      variance(results[35].uncertainty.drift),
      variance(results[34].uncertainty.drift) + 0.9 * variance(results[34].uncertainty.local));
  EXPECT_LE(errors_of(results, drive).largest, 0.3);
}

TEST_F(InertialOdometry, TheSameInputGivesTheSameBytes) {
  const MovingDrive drive = test::moving_drive(test::make_street(30.0), test::walk(1.5, 0.3),
                                               test::turned_mounting(), test::Lidar{}, 25);
  const auto a = place_all(context(), drive, walking_config());
  const auto b = place_all(context(), drive, walking_config());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(std::memcmp(a[i].T_map_lidar.data(), b[i].T_map_lidar.data(), 16 * sizeof(double)), 0)
        << "sweep " << i;
  }
}

}  // namespace
}  // namespace adit
