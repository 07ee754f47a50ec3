// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/executor/measurement_gate.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "adit/slam/gnss/gnss_noise.hpp"

namespace adit {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

GnssFix good_fix() {
  return {.kind = GnssFixKind::single,
          .latitude = 41.6,
          .longitude = -0.9,
          .altitude = 200.0,
          .covariance = std::nullopt};
}

/// What is left of the fix; fails where nothing is.
GnssFix passed(MeasurementGate& gate, const GnssFix& fix) {
  const auto result = gate.pass(fix);
  EXPECT_TRUE(result);
  return result ? std::get<GnssFix>(*result) : GnssFix{};
}

TEST(MeasurementGate, AFixWithoutAFiniteLatitudeAndLongitudeIsLeftOut) {
  MeasurementGate gate;
  for (const double bad : {kNotANumber, kInfinite, -kInfinite}) {
    GnssFix fix = good_fix();
    fix.latitude = bad;
    EXPECT_FALSE(gate.pass(fix));
    fix = good_fix();
    fix.longitude = bad;
    EXPECT_FALSE(gate.pass(fix));
  }
  EXPECT_TRUE(gate.pass(good_fix()));
  EXPECT_EQ(gate.faults().fixes, 7U);
  EXPECT_EQ(gate.faults().fixes_left_out, 6U);
}

TEST(MeasurementGate, AFixWithoutAnAltitudeKeepsItsLevelPosition) {
  MeasurementGate gate;
  EXPECT_FALSE(passed(gate, good_fix()).covariance);
  GnssFix fix = good_fix();
  fix.altitude = kNotANumber;
  fix.covariance = Eigen::Vector3d(0.01, 0.01, kNotANumber).asDiagonal();
  const GnssFix level = passed(gate, fix);
  EXPECT_EQ(level.altitude, 200.0) << "of the fix before";
  const Eigen::Matrix3d covariance = fix_covariance(level, {});
  EXPECT_TRUE(covariance.allFinite());
  EXPECT_FALSE(has_height(covariance));
  EXPECT_LT(covariance(0, 0), 10.0);
  EXPECT_TRUE(has_height(fix_covariance(good_fix(), {})));
  fix.covariance.reset();
  EXPECT_FALSE(has_height(fix_covariance(passed(gate, fix), {})));
  EXPECT_EQ(gate.faults().fixes_without_height, 2U);
  EXPECT_EQ(gate.faults().fixes_left_out, 0U);
}

TEST(MeasurementGate, ACovarianceThatIsNoneIsNotUsed) {
  MeasurementGate gate;
  for (const double bad : {kNotANumber, kInfinite, -1.0}) {
    GnssFix fix = good_fix();
    fix.covariance = Eigen::Vector3d(bad, 1.0, 1.0).asDiagonal();
    EXPECT_FALSE(passed(gate, fix).covariance) << bad;
  }
  EXPECT_EQ(gate.faults().fixes_without_covariance, 3U);
  GnssFix fix = good_fix();
  fix.covariance = Eigen::Vector3d(1.0, 1.0, kInfinite).asDiagonal();
  EXPECT_FALSE(has_height(fix_covariance(passed(gate, fix), {}))) << "the level part is whole";
  fix.covariance = Eigen::Matrix3d::Zero();
  EXPECT_TRUE(has_height(fix_covariance(passed(gate, fix), {})))
      << "a driver that fills nothing in is no fault";
  EXPECT_EQ(gate.faults().fixes_without_covariance, 3U);
}

TEST(MeasurementGate, AReceiverThatSaysItHasNoFixIsNoFault) {
  MeasurementGate gate;
  GnssFix blind = good_fix();
  blind.kind = GnssFixKind::none;
  blind.latitude = blind.longitude = blind.altitude = kNotANumber;
  EXPECT_TRUE(gate.pass(blind));
  EXPECT_FALSE(gate.faults().any());
}

TEST(MeasurementGate, IntensitiesAndTimesOfPointsThatAreNoneAreReplaced) {
  constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
  MeasurementGate gate;
  Sweep sweep;
  sweep.points = {{1.0F, 2.0F, 3.0F, kNoNumber}, {1.0F, 2.0F, 3.0F, 5.0F}};
  sweep.times = {1e30F, 0.1F};
  const auto result = gate.pass(sweep);
  ASSERT_TRUE(result);
  const Sweep& mended = std::get<Sweep>(*result);
  EXPECT_EQ(mended.points[0].intensity, 0.0F);
  EXPECT_EQ(mended.points[1].intensity, 5.0F);
  EXPECT_TRUE(std::isnan(mended.times[0]));
  EXPECT_EQ(duration_of(mended), static_cast<double>(0.1F));
  EXPECT_EQ(gate.faults().intensities, 1U);
  EXPECT_EQ(gate.faults().times, 1U);
}

TEST(MeasurementGate, ATransformThatIsNotFiniteIsLeftOut) {
  MeasurementGate gate;
  StaticTransform transform{.parent = "imu", .child = "lidar"};
  EXPECT_TRUE(gate.pass(transform));
  transform.T_parent_child.translation().x() = kNotANumber;
  EXPECT_FALSE(gate.pass(transform));
  EXPECT_EQ(gate.faults().transforms, 1U);
}

TEST(MeasurementGate, AVelocityIsLeftOutWhereItSaysNothing) {
  MeasurementGate gate;
  BodyVelocity velocity{.linear = {1.0, kNotANumber, kNotANumber}};
  EXPECT_TRUE(gate.pass(velocity)) << "an axis that is not measured is no fault";
  velocity.linear.setConstant(kNotANumber);
  EXPECT_FALSE(gate.pass(velocity));
  velocity.linear = {1.0, kInfinite, 0.0};
  EXPECT_FALSE(gate.pass(velocity));
  EXPECT_EQ(gate.faults().velocities, 3U);
  EXPECT_EQ(gate.faults().velocities_left_out, 2U);
}

TEST(MeasurementGate, AHeadingIsWrappedAndLeftOutWhereItSaysNothing) {
  MeasurementGate gate;
  const auto passed = gate.pass(Heading{.yaw = 7.0, .sigma = -1.0});
  ASSERT_TRUE(passed);
  EXPECT_NEAR(std::get<Heading>(*passed).yaw, 7.0 - 2.0 * std::acos(-1.0), 1e-12);
  EXPECT_FALSE(std::get<Heading>(*passed).sigma);
  EXPECT_FALSE(gate.pass(Heading{.yaw = kNotANumber}));
  EXPECT_FALSE(gate.pass(Heading{.yaw = kInfinite}));
  EXPECT_EQ(gate.faults().headings, 3U);
  EXPECT_EQ(gate.faults().headings_left_out, 2U);
  EXPECT_EQ(gate.faults().headings_without_sigma, 1U);
}

TEST(MeasurementGate, ACovarianceOfAVelocityThatNoneCanBeIsNotUsed) {
  MeasurementGate gate;
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d lopsided = identity;
  lopsided(0, 1) = 0.5;
  for (const Eigen::Matrix3d& bad : {Eigen::Matrix3d(-identity), Eigen::Matrix3d(0.0 * identity),
                                     Eigen::Matrix3d(kNotANumber * identity), lopsided}) {
    const auto passed = gate.pass(BodyVelocity{.covariance = bad});
    ASSERT_TRUE(passed);
    EXPECT_FALSE(std::get<BodyVelocity>(*passed).covariance);
  }
  const auto good = gate.pass(BodyVelocity{.covariance = 0.01 * identity});
  EXPECT_TRUE(std::get<BodyVelocity>(*good).covariance);
  EXPECT_EQ(gate.faults().velocities_without_covariance, 4U);
}

}  // namespace
}  // namespace adit
