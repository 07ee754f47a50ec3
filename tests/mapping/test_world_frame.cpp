// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/world_frame.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

/// Earth-centred coordinates on WGS 84, m.
Eigen::Vector3d geocentric(const Geodetic& place) {
  constexpr double kEquator = 6378137.0;
  constexpr double kFlattening = 1.0 / 298.257223563;
  constexpr double kE2 = kFlattening * (2.0 - kFlattening);
  const double lat = place.latitude * kDegree;
  const double lon = place.longitude * kDegree;
  const double n = kEquator / std::sqrt(1.0 - kE2 * std::sin(lat) * std::sin(lat));
  return {(n + place.altitude) * std::cos(lat) * std::cos(lon),
          (n + place.altitude) * std::cos(lat) * std::sin(lon),
          (n * (1.0 - kE2) + place.altitude) * std::sin(lat)};
}

constexpr Geodetic kPlaces[] = {{0.0, 10.0, 0.0},     {41.65, -0.88, 200.0},
                                {-60.0, 150.0, 30.0}, {48.0, 11.999, 1500.0},
                                {10.0, 179.999, 5.0}, {-33.0, -179.9999, 0.0}};

TEST(WorldFrame, ComesBackToThePlaceItCameFrom) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> metres(-10000.0, 10000.0);
  for (const Geodetic& origin : kPlaces) {
    const WorldFrame frame(origin);
    EXPECT_LT(frame.position_of(origin).norm(), 1e-6);
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d p(metres(random), metres(random), 0.01 * metres(random));
      EXPECT_LT((frame.position_of(frame.place_of(p)) - p).norm(), 1e-6);
    }
  }
}

TEST(WorldFrame, DistancesAreThoseOnTheGround) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> metres(-4000.0, 4000.0);
  for (const Geodetic& origin : kPlaces) {
    const WorldFrame frame(origin);
    for (int i = 0; i < 50; ++i) {
      // Both at the origin's altitude: then the distance on the ground is the chord, to 1e-8.
      const Eigen::Vector3d a(metres(random), metres(random), 0.0);
      const Eigen::Vector3d b =
          a + Eigen::Vector3d(0.1 * metres(random), 0.1 * metres(random), 0.0);
      const double chord = (geocentric(frame.place_of(a)) - geocentric(frame.place_of(b))).norm();
      EXPECT_NEAR((a - b).norm(), chord, 1e-6 * chord) << origin.latitude;
    }
  }
}

TEST(WorldFrame, AxesPointEastAndNorthAtTheOrigin) {
  const Geodetic origin{41.65, -0.88, 200.0};
  const WorldFrame frame(origin);
  const Eigen::Vector3d east = frame.position_of({41.65, -0.879, 200.0});
  EXPECT_NEAR(std::atan2(east.y(), east.x()), 0.0, 1e-5);
  const Eigen::Vector3d north = frame.position_of({41.651, -0.88, 200.0});
  EXPECT_NEAR(north.x(), 0.0, 1e-6);
  EXPECT_GT(north.y(), 110.0);
  EXPECT_NEAR(frame.convergence_at(Eigen::Vector3d::Zero()), 0.0, 1e-12);
  // 9 km east: the meridians have turned by sin(latitude) of the difference of longitude.
  const Eigen::Vector3d far(9000.0, 0.0, 0.0);
  const double turned = (frame.place_of(far).longitude + 0.88) * std::sin(41.65 * kDegree);
  EXPECT_NEAR(frame.convergence_at(far) * kDegreesPerRadian, turned, 1e-5);
}

TEST(WorldFrame, RefusesWhatIsNowhere) {
  EXPECT_THROW(WorldFrame({85.0, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(WorldFrame({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}),
               std::invalid_argument);
  EXPECT_THROW(WorldFrame({0.0, 0.0, std::numeric_limits<double>::infinity()}),
               std::invalid_argument);
}

// Figures of algorithms.md 11.1, from GeographicLib 2.1.2's own tool: UTM 30N at Zaragoza.
TEST(Utm, KnowsZonesHemispheresAndConvergence) {
  const UtmPosition utm = utm_of({41.65, -0.88, 0.0});
  EXPECT_EQ(utm.zone, 30);
  EXPECT_TRUE(utm.north);
  EXPECT_NEAR(utm.convergence * kDegreesPerRadian, 1.409, 1e-3);
  EXPECT_NEAR(utm.scale, 0.999984, 1e-6);
  const UtmPosition south = utm_of({-33.9, 18.4, 0.0});
  EXPECT_EQ(south.zone, 34);
  EXPECT_FALSE(south.north);
  EXPECT_GT(south.northing, 6e6);
}

TEST(Utm, AForcedZoneGoesOnBeyondItsEdge) {
  const Geodetic west{41.65, -0.0001, 0.0};
  const Geodetic east{41.65, 0.0001, 0.0};
  EXPECT_EQ(utm_of(east).zone, 31);
  const UtmZone zone{30, true};
  EXPECT_NEAR(utm_of(east, zone).easting - utm_of(west, zone).easting, 16.65, 0.05);
  const UtmZone north{36, true};
  const UtmPosition a = utm_of({0.0001, 33.0, 0.0}, north);
  const UtmPosition b = utm_of({-0.0001, 33.0, 0.0}, north);
  EXPECT_NEAR(a.northing - b.northing, 22.1, 0.1);
  for (const Geodetic& place : kPlaces) {
    const UtmPosition utm = utm_of(place);
    const Geodetic back = place_of(utm, place.altitude);
    EXPECT_NEAR(back.latitude, place.latitude, 1e-10);
    EXPECT_NEAR(back.longitude, place.longitude, 1e-10);
  }
}

}  // namespace
}  // namespace adit
