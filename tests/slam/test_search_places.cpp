// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/search_places.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

Eigen::Isometry3d pose(double x, double heading = 0.0) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = x;
  T.linear() = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// Some place is this near.
bool covers(const std::vector<Eigen::Isometry3d>& places, const Eigen::Isometry3d& wanted,
            double distance, double turn) {
  return std::ranges::any_of(places, [&](const Eigen::Isometry3d& place) {
    const Eigen::Isometry3d off = place.inverse() * wanted;
    return off.translation().norm() < distance && rotation_angle(off.linear()) < turn;
  });
}

TEST(SearchPlaces, ATrustedPredictionIsNotSearchedFor) {
  Prediction prediction;
  prediction.trusted = true;
  EXPECT_TRUE(places_to_search(prediction).empty());
}

TEST(SearchPlaces, OneThatIsNotTrustedIsSearchedForOnTheSpot) {
  Prediction prediction;
  prediction.T_map_lidar = pose(3.0);
  const auto places = places_to_search(prediction);
  ASSERT_EQ(places.size(), 1U);
  EXPECT_TRUE(places[0].isApprox(prediction.T_map_lidar));
}

TEST(SearchPlaces, ALostSensorIsSearchedForInEveryHeadingAndAround) {
  Prediction prediction;
  prediction.lost = true;
  prediction.T_map_lidar = pose(3.0);
  prediction.T_map_onward = pose(20.0);
  const auto places = places_to_search(prediction);
  EXPECT_EQ(places.size(), kMostPlaces);
  for (int k = 0; k < 8; ++k) {
    EXPECT_TRUE(covers(places, pose(3.0, 0.785398 * k), 1e-6, 1e-3)) << k;
  }
  EXPECT_TRUE(covers(places, pose(5.0), 1e-6, 1e-6));
  EXPECT_TRUE(covers(places, pose(20.0), 1e-6, 1e-6));
}

// What a hand does to a sensor between two sweeps of 2 Hz: it stops, goes on, or turns.
TEST(SearchPlaces, AfterARejectionEveryMotionBetweenRestAndGoingOnIsCovered) {
  const PossibleMotions motions{
      .predicted = pose(2.2, 0.4), .steady = pose(2.0), .at_rest = pose(0.0)};
  const auto places = places_after_rejection(motions);
  EXPECT_LE(places.size(), kMostPlaces);
  EXPECT_TRUE(covers(places, motions.predicted, 1e-6, 1e-6));
  for (const double x : {0.0, 1.0, 2.0}) {
    EXPECT_TRUE(covers(places, pose(x), 1e-6, 1e-6)) << x;
  }
  for (const double turn : {-0.8, -0.5, -0.2, 0.2, 0.5, 0.8}) {
    EXPECT_TRUE(covers(places, pose(0.0, turn), 1e-6, 0.21)) << turn;
    EXPECT_TRUE(covers(places, pose(2.0, turn), 1e-6, 0.21)) << turn;
  }
}

}  // namespace
}  // namespace adit
