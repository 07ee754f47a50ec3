// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_world.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace adit {
namespace {

/// The map's x axis points 90 degrees north of east, and its origin lies 1 km to the east.
Georeference turned_a_quarter(double latitude) {
  Georeference earth{.origin = {latitude, 11.5, 500.0}};
  earth.T_world_map.translation() << 1000.0, 0.0, 2.0;
  earth.T_world_map.rotate(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ()));
  return earth;
}

TEST(ViewWorldTest, NorthIsTrueNorthAtTheMapsOrigin) {
  const Georeference earth = turned_a_quarter(48.0);
  const nlohmann::ordered_json world = world_of(earth);
  const WorldFrame frame(earth.origin);
  Geodetic place = frame.place_of(earth.T_world_map.translation());
  place.latitude += 1e-4;
  const Eigen::Vector3d north =
      (earth.T_world_map.inverse() * frame.position_of(place)).normalized();
  EXPECT_GT(std::abs(north.y()), 1e-4) << "meridians converge";
  EXPECT_NEAR(world.at("north").at(0).get<double>(), north.x(), 1e-7);
  EXPECT_NEAR(world.at("north").at(1).get<double>(), north.y(), 1e-7);
  EXPECT_EQ(world.at("coordinates"), "WGS 84 / UTM zone 32N, heights above the ellipsoid");
  EXPECT_TRUE(world_of(std::nullopt).is_null());
}

TEST(ViewWorldTest, APlaceIsToldInAllCoordinates) {
  const Georeference earth = turned_a_quarter(48.0);
  const auto answer = nlohmann::json::parse(place_answer(earth, {100.0, 0.0, 8.0}));
  EXPECT_EQ(answer.at("p").dump(), "[100.0,0.0,8.0]");
  const Geodetic expected = WorldFrame(earth.origin).place_of({1000.0, 100.0, 10.0});
  const nlohmann::json& place = answer.at("world");
  EXPECT_NEAR(place.at("latitude").get<double>(), expected.latitude, 1e-12);
  EXPECT_NEAR(place.at("longitude").get<double>(), expected.longitude, 1e-12);
  EXPECT_NEAR(place.at("altitude").get<double>(), 510.0, 1e-6);
  const UtmPosition utm = utm_of(expected);
  EXPECT_EQ(place.at("utm").at("zone"), "32N");
  EXPECT_NEAR(place.at("utm").at("easting").get<double>(), utm.easting, 1e-6);
  EXPECT_NEAR(place.at("utm").at("northing").get<double>(), utm.northing, 1e-6);
}

TEST(ViewWorldTest, WhatIsNowhereOnTheEarthIsToldInTheMapAlone) {
  EXPECT_TRUE(
      nlohmann::json::parse(place_answer(std::nullopt, {1.0, 2.0, 3.0})).at("world").is_null());
  EXPECT_TRUE(nlohmann::json::parse(place_answer(turned_a_quarter(48.0), {1e300, 2.0, 3.0}))
                  .at("world")
                  .is_null());
}

}  // namespace
}  // namespace adit
