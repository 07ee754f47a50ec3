// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/high_rate_stream.hpp"

#include <gtest/gtest.h>

#include "adit/slam/odometry/odometry.hpp"
#include "adit/tests/slam/odometry_fixture.hpp"
#include "adit/tests/support/moving_drive.hpp"
#include "adit/tests/support/numerical_jacobian.hpp"

namespace adit {
namespace {

InertialReport fused_at(const test::WavyMotion& motion, double time) {
  InertialReport report;
  report.state = InertialState::fused;
  report.nav = motion.state(time);
  report.nav_covariance = 1e-4 * StateMatrix::Identity();
  report.T_body_lidar = test::turned_mounting();
  return report;
}

/// Readings of the motion at 200 Hz from `begin` to `end`, in s, into the stream.
std::vector<LidarMotion> feed(HighRateStream& stream, const test::WavyMotion& motion, double begin,
                              double end, double per_unit = 1.0) {
  std::vector<LidarMotion> given;
  for (ImuSample sample : test::readings(motion, begin, end, 200.0)) {
    sample.linear_acceleration /= per_unit;
    if (const auto pose = stream.add(sample, ImuArrival::appended)) {
      given.push_back(*pose);
    }
  }
  return given;
}

double error_of(const LidarMotion& given, const test::WavyMotion& motion) {
  const Eigen::Isometry3d truth =
      motion.state(seconds(given.stamp)).T_map_body * test::turned_mounting();
  return (truth.inverse() * given.T_map_lidar).translation().norm();
}

TEST(HighRateStream, GivesTheLidarFromTheFirstFusedSweepOn) {
  const test::WavyMotion motion = test::hand_held_motion();
  HighRateStream stream({}, 0.0);
  EXPECT_TRUE(feed(stream, motion, 0.0, 0.2).empty());
  stream.update(fused_at(motion, 0.1));
  const auto given = feed(stream, motion, 0.205, 0.4);
  ASSERT_EQ(given.size(), 40U);
  for (const LidarMotion& pose : given) {
    EXPECT_LE(error_of(pose, motion), 1e-3);
  }
  // The velocity is that of the lidar, which the body swings about.
  for (size_t i = 1; i + 1 < given.size(); ++i) {
    const Eigen::Vector3d moved =
        (given[i + 1].T_map_lidar.translation() - given[i - 1].T_map_lidar.translation()) / 0.01;
    EXPECT_LE((moved - given[i].v_map_lidar).norm(), 3e-3) << i;
  }
}

TEST(HighRateStream, NothingIsGivenBehindAGapUntilTheNextFusedSweep) {
  const test::WavyMotion motion = test::hand_held_motion();
  HighRateStream stream({}, 0.0);
  feed(stream, motion, 0.0, 0.1);
  stream.update(fused_at(motion, 0.0));
  EXPECT_EQ(feed(stream, motion, 0.105, 0.2).size(), 20U);
  EXPECT_TRUE(feed(stream, motion, 0.4, 0.5).empty());
  stream.update(fused_at(motion, 0.1));
  EXPECT_TRUE(feed(stream, motion, 0.505, 0.55).empty()) << "the sweep is from before the gap";
  stream.update(fused_at(motion, 0.45));
  const auto given = feed(stream, motion, 0.555, 0.6);
  ASSERT_EQ(given.size(), 10U);
  EXPECT_LE(error_of(given.back(), motion), 1e-3);
}

TEST(HighRateStream, NothingIsGivenWhileNotFusedOrLongAfterTheLastSweep) {
  const test::WavyMotion motion = test::hand_held_motion();
  HighRateStream stream({}, 0.0);
  feed(stream, motion, 0.0, 0.1);
  stream.update(fused_at(motion, 0.05));
  EXPECT_EQ(feed(stream, motion, 0.105, 3.0).size(), 190U) << "a second after the sweep";
  stream.update(fused_at(motion, 2.9));
  EXPECT_FALSE(feed(stream, motion, 3.005, 3.05).empty());
  InertialReport lost;
  lost.state = InertialState::lost;
  stream.update(lost);
  EXPECT_TRUE(feed(stream, motion, 3.055, 3.1).empty());
}

TEST(HighRateStream, StampsRiseThoughTheClockWasSetBack) {
  const test::WavyMotion motion = test::hand_held_motion();
  HighRateStream stream({}, 0.0);
  feed(stream, motion, 2.0, 2.1);
  stream.update(fused_at(motion, 2.0));
  const auto before = feed(stream, motion, 2.105, 2.2);
  ASSERT_FALSE(before.empty());
  stream.add(motion.sample(0.0), ImuArrival::restarted);
  EXPECT_TRUE(feed(stream, motion, 0.005, 2.1).empty());
  stream.update(fused_at(motion, 2.0));
  const auto after = feed(stream, motion, 2.105, 2.3);
  ASSERT_EQ(after.size(), 20U);
  EXPECT_GT(after.front().stamp, before.back().stamp);
}

TEST(HighRateStream, TakesTheUnitThatTheStartFound) {
  const test::WavyMotion motion = test::hand_held_motion();
  HighRateStream stream({}, 0.0);
  feed(stream, motion, 0.0, 0.2, kStandardGravity);
  for (const double at : {0.1, 0.2, 0.3}) {
    InertialReport report = fused_at(motion, at);
    report.accel_scale = kStandardGravity;
    stream.update(report);
    for (const LidarMotion& pose : feed(stream, motion, at + 0.105, at + 0.2, kStandardGravity)) {
      EXPECT_LE(error_of(pose, motion), 1e-3) << at;
    }
  }
  EXPECT_TRUE(stream.add(motion.sample(0.505), ImuArrival::appended));
}

/// Readings of a clock that is late.
std::vector<LidarMotion> feed_late(HighRateStream& stream, const test::WavyMotion& motion,
                                   double begin, double end, Nanoseconds late) {
  std::vector<LidarMotion> given;
  for (ImuSample sample : test::readings(motion, begin, end, 200.0)) {
    sample.stamp += late;
    if (const auto pose = stream.add(sample, ImuArrival::appended)) {
      given.push_back(*pose);
    }
  }
  return given;
}

TEST(HighRateStream, FollowsTheClockThatWasRefined) {
  const test::WavyMotion motion = test::hand_held_motion();
  const Nanoseconds late = std::chrono::milliseconds(40);
  HighRateStream stream({}, 0.0);
  feed_late(stream, motion, 0.0, 0.2, late);
  stream.update(fused_at(motion, 0.1));
  const auto before = feed_late(stream, motion, 0.205, 0.3, late);
  ASSERT_FALSE(before.empty());
  EXPECT_GT(error_of(before.back(), motion), 5e-3) << "as the clock says, it is elsewhere";
  InertialReport refined;
  refined.state = InertialState::lost;
  refined.clock_offset = seconds(late);
  stream.update(refined);
  EXPECT_TRUE(feed_late(stream, motion, 0.305, 0.5, late).empty());
  refined = fused_at(motion, 0.4);
  refined.clock_offset = seconds(late);
  stream.update(refined);
  const auto after = feed_late(stream, motion, 0.505, 0.6, late);
  ASSERT_EQ(after.size(), 20U);
  for (const LidarMotion& pose : after) {
    EXPECT_LE(error_of(pose, motion), 1e-3);
  }
  EXPECT_LE(std::abs(seconds(after.front().stamp) - 0.505), 1e-6) << "in the clock of the sweeps";
}

TEST(HighRateStream, FollowsTheMountingThatWasRefined) {
  const test::WavyMotion motion = test::hand_held_motion();
  HighRateStream stream({}, 0.0);
  feed(stream, motion, 0.0, 0.2);
  InertialReport report = fused_at(motion, 0.1);
  report.T_body_lidar.linear() = report.T_body_lidar.linear() * so3_exp({0.0, 0.0, 0.05});
  stream.update(report);
  const auto turned = [&](const LidarMotion& given) {
    const Eigen::Isometry3d truth =
        motion.state(seconds(given.stamp)).T_map_body * test::turned_mounting();
    return rotation_angle((truth.inverse() * given.T_map_lidar).linear());
  };
  EXPECT_NEAR(turned(feed(stream, motion, 0.205, 0.3).back()), 0.05, 2e-3);
  stream.update(fused_at(motion, 0.2));
  EXPECT_LE(turned(feed(stream, motion, 0.305, 0.4).back()), 2e-3);
}

TEST(HighRateStream, TheCovarianceOfTheLidarIsTheBodysPassedOn) {
  HighRateState state;
  state.nav = test::hand_held_motion().state(0.7);
  const Eigen::Vector3d reading(0.4, -1.2, 0.8);
  const auto lidar_of = [&](const StateVector& delta) {
    HighRateState moved = state;
    moved.nav = retract(state.nav, delta);
    moved.angular_velocity = reading - moved.nav.bias.gyro;
    return lidar_motion(moved, test::turned_mounting());
  };
  const LidarMotion at = lidar_of(StateVector::Zero());
  using Vector9 = Eigen::Matrix<double, 9, 1>;
  const auto jacobian = test::numerical_jacobian<9, kStateSize>([&](const StateVector& delta) {
    const LidarMotion moved = lidar_of(delta);
    const Eigen::Isometry3d off = at.T_map_lidar.inverse() * moved.T_map_lidar;
    Vector9 change;
    change << off.translation(), so3_log(off.linear()), moved.v_map_lidar - at.v_map_lidar;
    return change;
  });
  StateMatrix root = StateMatrix::Identity();
  root.triangularView<Eigen::StrictlyLower>().setConstant(0.3);
  state.covariance = root * root.transpose();
  state.angular_velocity = reading - state.nav.bias.gyro;
  const Matrix9d expected = jacobian * state.covariance * jacobian.transpose();
  const Matrix9d found = lidar_motion(state, test::turned_mounting()).covariance;
  EXPECT_LE((found - expected).norm(), 1e-6 * expected.norm());
}

class HighRateOfADrive : public test::DeviceTest {};

/// What a stream gives beside an odometry.
std::vector<LidarMotion> follow(engine::Context& context, const test::MovingDrive& drive,
                                double smoothing) {
  Config config = test::street_config();
  config.imu.T_imu_lidar = numbers_of(test::turned_mounting());
  Odometry odometry(context, config);
  HighRateStream stream(config.imu, smoothing);
  std::vector<LidarMotion> given;
  size_t fed = 0;
  for (const Sweep& sweep : drive.sweeps) {
    const Nanoseconds end = sweep.stamp + std::chrono::milliseconds(105);
    for (; fed < drive.readings.size() && drive.readings[fed].stamp <= end; ++fed) {
      for (const TakenReading& taken : odometry.add(drive.readings[fed])) {
        if (const auto pose = stream.add(taken.sample, taken.arrival)) {
          given.push_back(*pose);
        }
      }
    }
    stream.update(odometry.step(sweep).inertial);
  }
  return given;
}

TEST_F(HighRateOfADrive, PosesAgreeWithTheTruthAndAreTheSameBytesTwice) {
  const test::WavyMotion motion = test::walk(1.5, 0.3);
  const test::MovingDrive drive = test::moving_drive(test::make_street(30.0), motion,
                                                     test::turned_mounting(), test::Lidar{}, 50);
  for (const double smoothing : {0.0, 0.05}) {
    const auto given = follow(context(), drive, smoothing);
    ASSERT_GT(given.size(), 600U);
    const auto truth_at = [&](Nanoseconds stamp) {
      return Eigen::Isometry3d(motion.state(seconds(stamp)).T_map_body * test::turned_mounting());
    };
    const size_t first = given.size() / 3;
    double sum = 0.0;
    for (size_t i = first; i < given.size(); ++i) {
      EXPECT_GT(given[i].stamp, given[i - 1].stamp);
      const Eigen::Isometry3d estimate = given[first].T_map_lidar.inverse() * given[i].T_map_lidar;
      const Eigen::Isometry3d truth =
          truth_at(given[first].stamp).inverse() * truth_at(given[i].stamp);
      const Eigen::Isometry3d off = truth.inverse() * estimate;
      sum += off.translation().squaredNorm();
      EXPECT_LE(rotation_angle(off.linear()), 0.015);
      EXPECT_LE(given[i].covariance.diagonal().head<3>().sum(), 0.3 * 0.3);
      EXPECT_GT(given[i].covariance.diagonal().minCoeff(), 0.0);
    }
    const double rms = std::sqrt(sum / static_cast<double>(given.size() - first));
    RecordProperty("rms_m", std::to_string(rms));
    EXPECT_LE(rms, 0.05);
    const auto again = follow(context(), drive, smoothing);
    ASSERT_EQ(again.size(), given.size());
    for (size_t i = 0; i < given.size(); ++i) {
      ASSERT_EQ(given[i].stamp, again[i].stamp);
      ASSERT_EQ(given[i].T_map_lidar.matrix(), again[i].T_map_lidar.matrix());
      ASSERT_EQ(given[i].covariance, again[i].covariance);
    }
  }
}

}  // namespace
}  // namespace adit
