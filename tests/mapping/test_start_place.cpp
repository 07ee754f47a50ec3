// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/start_place.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

const Geodetic kOrigin{.latitude = 48.0, .longitude = 11.0, .altitude = 500.0};

Eigen::Isometry3d pose(double x, double y, double z, double yaw) {
  Eigen::Isometry3d T(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

double chi2(const Eigen::Isometry3d& expected, const Eigen::Isometry3d& truth,
            const Matrix6d& covariance) {
  const Vector6d off = se3_log(expected.inverse() * truth);
  return off.dot(covariance.ldlt().solve(off));
}

TEST(StartPlace, TheLidarIsWhereItIsGuessedAndKeepsTheTiltOfTheOdometry) {
  Eigen::Isometry3d T_odom_lidar = pose(0.3, -0.2, 1.1, 0.7);
  T_odom_lidar.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()));
  const ExpectedStart start =
      expected_start({.position = {12.0, -3.0, 1.5}, .heading = -2.0}, T_odom_lidar);
  const Eigen::Isometry3d T_map_lidar = start.T_map_odom * T_odom_lidar;
  EXPECT_LT((T_map_lidar.translation() - Eigen::Vector3d(12.0, -3.0, 1.5)).norm(), 1e-12);
  EXPECT_NEAR(std::atan2(T_map_lidar.linear()(1, 0), T_map_lidar.linear()(0, 0)), -2.0, 1e-12);
  EXPECT_LT((T_map_lidar.linear().row(2) - T_odom_lidar.linear().row(2)).norm(), 1e-12);
  EXPECT_LT(start.covariance(2, 2), start.covariance(0, 0)) << "people know the floor";
}

// North of one origin is not north of the other: 20 km to the east, by 0.2 degrees.
TEST(StartPlace, MapsWithOriginsFarApartLieAtTheSamePlaceOnTheEarth) {
  const Geodetic east{.latitude = 48.01, .longitude = 11.27, .altitude = 510.0};
  const WorldFrame frame(kOrigin);
  const WorldFrame other_frame(east);
  const Georeference map{.origin = kOrigin, .T_world_map = pose(20'100.0, 900.0, -3.0, 0.4)};
  const Georeference other{.origin = east, .T_world_map = pose(-40.0, 25.0, 2.0, -1.3)};
  const ExpectedStart start = expected_start(map, other, Eigen::Isometry3d::Identity());
  for (const Eigen::Vector3d& p_other :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(100, 0, 0), Eigen::Vector3d(-30, 90, 5)}) {
    const Geodetic place = other_frame.place_of(other.T_world_map * p_other);
    const Eigen::Vector3d p_map = map.T_world_map.inverse() * frame.position_of(place);
    EXPECT_LT((start.T_map_odom * p_other - p_map).norm(), 0.01);
  }
  EXPECT_NEAR(start.covariance(0, 0), covariance_of_guess()(0, 0), 1e-12)
      << "both places are exact, and a datum may still differ";
}

/// Fixes of a drive that bends, 2 m and 1 s apart, with white errors of 0.5 m and twice as much in
/// height, of which the odometry's frame lies at T_map_odom in a map that is georeferenced.
class FixDrive {
 public:
  explicit FixDrive(unsigned seed) : random_(seed) {}

  void add_next(StartByFixes& start) {
    ++count_;
    T_odom_keyframe = T_odom_keyframe * pose(2.0, 0.0, 0.0, 0.03);
    const Eigen::Vector3d error(noise_(random_), noise_(random_), 2.0 * noise_(random_));
    const Eigen::Vector3d p_world =
        map.T_world_map * T_map_odom * T_odom_keyframe * kAntenna + error;
    MapFix fix{.stamp = Nanoseconds{static_cast<int64_t>(count_) * 1'000'000'000},
               .place = WorldFrame(kOrigin).place_of(p_world)};
    fix.covariance.diagonal() = Eigen::Vector3d(0.25, 0.25, 1.0);
    fix.p_keyframe_antenna = kAntenna;
    start.add({&fix, 1}, T_odom_keyframe);
  }

  const Eigen::Vector3d kAntenna{0.2, -0.1, 0.9};
  const Georeference map{.origin = kOrigin, .T_world_map = pose(30.0, -12.0, 4.0, 2.5)};
  const Eigen::Isometry3d T_map_odom = pose(100.0, 7.0, -1.0, 0.8);
  Eigen::Isometry3d T_odom_keyframe = Eigen::Isometry3d::Identity();

 private:
  std::mt19937 random_;
  std::normal_distribution<double> noise_{0.0, 0.5};
  std::size_t count_ = 0;
};

TEST(StartByFixes, FindsThePlaceOnceTheHeadingIsKnownAndKnowsHowWell) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    FixDrive drive(seed);
    StartByFixes start(drive.map, 0.1, true);
    std::optional<ExpectedStart> found;
    std::size_t asked = 0;
    for (; !found && asked < 60; ++asked) {
      drive.add_next(start);
      found = start.find(Eigen::Vector3d::UnitZ(), drive.T_odom_keyframe);
    }
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_GT(asked, 4U) << "errors of 0.5 m do not tell a heading on a few metres";
    EXPECT_LT(chi2(found->T_map_odom * drive.T_odom_keyframe,
                   drive.T_map_odom * drive.T_odom_keyframe, found->covariance),
              16.81)
        << "seed " << seed;
  }
}

TEST(StartByFixes, WhatStandsOrWasClearedSaysNothing) {
  FixDrive drive(1);
  StartByFixes start(drive.map, 0.1, true);
  EXPECT_FALSE(start.find(Eigen::Vector3d::UnitZ(), drive.T_odom_keyframe));
  for (int i = 0; i < 40; ++i) {
    drive.T_odom_keyframe = Eigen::Isometry3d::Identity();
    drive.add_next(start);
  }
  EXPECT_FALSE(start.find(Eigen::Vector3d::UnitZ(), drive.T_odom_keyframe));
  for (int i = 0; i < 40; ++i) {
    drive.add_next(start);
  }
  EXPECT_TRUE(start.find(Eigen::Vector3d::UnitZ(), drive.T_odom_keyframe));
  start.clear();
  EXPECT_FALSE(start.find(Eigen::Vector3d::UnitZ(), drive.T_odom_keyframe));
}

TEST(StartByFixes, PositionsThatAreNoneArePassedOver) {
  FixDrive drive(2);
  StartByFixes start(drive.map, 0.1, false);
  for (const double latitude : {std::nan(""), 89.9, -1e300}) {
    MapFix fix{.place = {.latitude = latitude, .longitude = 11.0}};
    start.add({&fix, 1}, drive.T_odom_keyframe);
  }
  for (int i = 0; i < 40; ++i) {
    drive.add_next(start);
  }
  const auto found = start.find(Eigen::Vector3d::UnitZ(), drive.T_odom_keyframe);
  ASSERT_TRUE(found);
  EXPECT_GT(found->covariance(2, 2), 9.0) << "heights do not count";
}

}  // namespace
}  // namespace adit
