// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What products of a map are in: zones, projected systems by name, heights above the sea, times.
#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <GeographicLib/LambertConformalConic.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

TEST(ProductCoordinates, NamesItsZone) {
  EXPECT_EQ(to_string(*parse_utm_zone("30N")), "30N");
  EXPECT_EQ(epsg_of(*parse_utm_zone("7S")), 32707);
  for (const char* wrong : {"", "N", "0N", "61N", "30", "30X", "N30", "30NN"}) {
    EXPECT_FALSE(parse_utm_zone(wrong)) << wrong;
  }
  const ProductCoordinates south({.origin = {-33.0, 151.0, 20.0}}, ProductFrame::utm);
  EXPECT_NE(south.wkt().find("EPSG\",\"32756"), std::string::npos) << south.wkt();
  EXPECT_EQ(ProductCoordinates().wkt(), "");
}

TEST(LasWriter, GpsTimeHasTheLeapSecondsOfItsDate) {
  // 2017-01-01T00:00:00Z is GPS 1167264018 s; a second of UNIX time before it, one leap less.
  EXPECT_EQ(adjusted_gps_time(std::chrono::seconds(1'483'228'800)), 167'264'018.0);
  EXPECT_EQ(adjusted_gps_time(std::chrono::seconds(1'483'228'799)), 167'264'016.0);
  EXPECT_EQ(adjusted_gps_time(std::chrono::milliseconds(1'700'000'000'250)), 384'035'218.25);
  EXPECT_FALSE(is_unix_time(Nanoseconds(0)));
}

TEST(CloudSelection, APolygonMayBeConcave) {
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}};
  EXPECT_TRUE(is_within(corners, {1.0, 1.0}));
  EXPECT_FALSE(is_within(corners, {2.0, 3.0}));
  EXPECT_FALSE(is_within(corners, {5.0, 1.0}));
}

TEST(ProjectedSystem, IsThatOfGeographicLib) {
  const ProjectedSystem utm("EPSG:32630");
  EXPECT_EQ(utm.name(), "WGS 84 / UTM zone 30N");
  EXPECT_EQ(utm.epsg(), 32630);
  EXPECT_NE(utm.wkt().find("PROJCS["), std::string::npos) << utm.wkt();
  const ProjectedSystem lambert("EPSG:2154");  // RGF93 / Lambert-93, the parameters of its register
  const GeographicLib::LambertConformalConic cone(6378137.0, 1.0 / 298.257222101, 44.0, 49.0, 1.0);
  double x0 = 0.0;
  double y0 = 0.0;
  cone.Forward(3.0, 46.5, 3.0, x0, y0);
  for (const Geodetic& place :
       {Geodetic{41.65, -0.88, 612.3}, Geodetic{48.8566, 2.3522, 35.0}, Geodetic{43.3, 5.4, 0.0}}) {
    if (place.longitude < 3.0) {  // beyond the zone's neighbourhood GeographicLib has none
      const UtmPosition expected = utm_of(place, UtmZone{.zone = 30, .north = true});
      const Eigen::Vector2d found = utm.position_of(place);
      EXPECT_NEAR(found.x(), expected.easting, 1e-4);
      EXPECT_NEAR(found.y(), expected.northing, 1e-4);
    }
    double x = 0.0;
    double y = 0.0;
    cone.Forward(3.0, place.latitude, place.longitude, x, y);
    const Eigen::Vector2d in_lambert = lambert.position_of(place);
    EXPECT_NEAR(in_lambert.x(), 700'000.0 + x - x0, 1e-4);
    EXPECT_NEAR(in_lambert.y(), 6'600'000.0 + y - y0, 1e-4);
  }
}

TEST(ProjectedSystem, SaysWhyItCannotBeUsed) {
  const auto complaint = [](const std::string& definition, const Geodetic& place) -> std::string {
    try {
      static_cast<void>(ProjectedSystem(definition).position_of(place));
    } catch (const NoSuchSystem& error) {
      return error.what();
    }
    return "";
  };
  const Geodetic saragossa{41.65, -0.88, 200.0};
  EXPECT_EQ(complaint("EPSG:25830", saragossa), "");
  EXPECT_NE(complaint("EPSG:99999", saragossa).find("knows no"), std::string::npos);
  EXPECT_NE(complaint("", saragossa).find("knows no"), std::string::npos);
  EXPECT_NE(complaint("EPSG:4326", saragossa).find("no projected system"), std::string::npos);
  EXPECT_NE(complaint("EPSG:2225", saragossa).find("metres"), std::string::npos) << "feet";
  EXPECT_NE(complaint("EPSG:25830", {-33.0, 151.0, 0.0}).find("does not cover"), std::string::npos);
  EXPECT_EQ(complaint("EPSG:32760", {-18.0, -179.5, 0.0}), "") << "across 180 degrees";
}

/// A geoid of one slope: 50 m at the equator, and half a metre a degree northwards.
fs::path sloping_geoid(const fs::path& folder) {
  constexpr int kColumns = 360;
  constexpr int kRows = 181;
  std::string text = "P5\n# Offset -108\n# Scale 0.003\n";
  text += std::to_string(kColumns) + " " + std::to_string(kRows) + "\n65535\n";
  for (int row = 0; row < kRows; ++row) {
    const double height = 50.0 + 0.5 * (90.0 - row);
    const auto stored = static_cast<uint16_t>(std::lround((height + 108.0) / 0.003));
    for (int column = 0; column < kColumns; ++column) {
      text += {static_cast<char>(stored >> 8U), static_cast<char>(stored & 0xffU)};
    }
  }
  write_text_file(folder / "slope.pgm", text);
  return folder / "slope.pgm";
}

TEST(Geoid, TellsHeightsAboveTheSea) {
  const test::TemporaryFolder folder;
  const Geoid geoid(sloping_geoid(folder.path()));
  EXPECT_EQ(geoid.name(), "slope");
  EXPECT_NEAR(geoid.height_at({41.65, -0.88, 0.0}), 50.0 + 0.5 * 41.65, 0.002);
  EXPECT_NEAR(geoid.orthometric({10.25, 179.9, 100.0}), 100.0 - 50.0 - 0.5 * 10.25, 0.002);
  EXPECT_THROW(Geoid(folder.path() / "none.pgm"), std::invalid_argument);
  EXPECT_THROW(Geoid(folder.path() / "slope"), std::invalid_argument);
  write_text_file(folder.path() / "short.pgm",
                  "P5\n# Offset -108\n# Scale 0.003\n360 181\n65535\nab");
  EXPECT_THROW(Geoid(folder.path() / "short.pgm"), std::invalid_argument);
}

TEST(ProductCoordinates, OfANamedSystemAndAboveAGeoid) {
  const test::TemporaryFolder folder;
  const Georeference placed{
      .origin = {41.65, -0.88, 612.3},
      .T_world_map = Eigen::Isometry3d(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()))};
  const Geoid geoid(sloping_geoid(folder.path()));
  const ProductCoordinates utm(placed, ProductFrame::utm);
  const ProductCoordinates named(placed, ProductFrame::named,
                                 {.named = ProjectedSystem("EPSG:32630"), .geoid = geoid});
  const ProductCoordinates lambert(placed, ProductFrame::named,
                                   {.named = ProjectedSystem("EPSG:2154")});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> metres(-4000.0, 4000.0);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p(metres(random), metres(random), 0.01 * metres(random));
    const Eigen::Vector3d found = named.from_map(p);
    const Geodetic place = named.place(p).geodetic;
    EXPECT_LT((found - utm.from_map(p)).head<2>().norm(), 1e-4);
    EXPECT_NEAR(found.z(), geoid.orthometric(place), 1e-3);
    EXPECT_LT((found - named.from_geodetic(place)).norm(), 1e-3);
    EXPECT_LT((lambert.from_map(p) - lambert.from_geodetic(place)).norm(), 1e-3);
    // Axes of the grid.
    const Eigen::Isometry3d pose =
        Eigen::Translation3d(p) * Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ());
    EXPECT_LT(
        rotation_angle(named.from_map(pose).linear().transpose() * utm.from_map(pose).linear()),
        1e-7);
    const Eigen::Vector3d ahead =
        lambert.from_map(Eigen::Vector3d(pose * Eigen::Vector3d(10, 0, 0)));
    EXPECT_NEAR((lambert.from_map(pose).inverse() * ahead).y(), 0.0, 1e-4);
  }
  EXPECT_EQ(named.epsg(), 32630);
  EXPECT_EQ(named.name(), "WGS 84 / UTM zone 30N, heights above the geoid slope");
  EXPECT_NE(named.wkt().find("VERT_DATUM[\"slope geoid\",2005]"), std::string::npos) << named.wkt();
  EXPECT_THROW(
      ProductCoordinates(placed, ProductFrame::named, {.named = ProjectedSystem("EPSG:28356")}),
      NoSuchSystem);
}

}  // namespace
}  // namespace adit
