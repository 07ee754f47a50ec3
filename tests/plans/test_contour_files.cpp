// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Contour lines as GeoJSON, GeoPackage and DXF: the same places in all of them.
#include "adit/tools/export/contour_files.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/sqlite_database.hpp"
#include "adit/tools/map_products/geopackage.hpp"

namespace adit {
namespace {

/// In UTM, somewhere near 48 N, 11 E: a closed line of 500 m, and an open one of 500.5 m.
std::vector<ContourLine> lines_at(const Eigen::Vector2d& corner) {
  return {{.height = 500.0,
           .places = {corner, corner + Eigen::Vector2d(10.0, 0.0),
                      corner + Eigen::Vector2d(10.0, 10.0)},
           .closed = true},
          {.height = 500.5, .places = {corner, corner + Eigen::Vector2d(900.0, 700.0)}}};
}

class ContourFiles : public testing::Test {
 protected:
  ContourFiles() {
    Georeference placed{.origin = {48.0, 11.0, 510.0}};
    placed.T_world_map = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ());
    coordinates_ = ProductCoordinates(placed, ProductFrame::utm);
    lines_ = lines_at(coordinates_.origin().head<2>());
    sheet_ = {.lines = &lines_, .step = 0.5, .coordinates = &coordinates_};
  }

  ProductCoordinates coordinates_;
  std::vector<ContourLine> lines_;
  ContourSheet sheet_;
};

TEST_F(ContourFiles, GeoJsonHasDegreesAndHeights) {
  const auto json = nlohmann::json::parse(contours_geojson(sheet_));
  ASSERT_EQ(json.at("features").size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& feature = json.at("features").at(i);
    EXPECT_EQ(feature.at("properties").at("height_m"), lines_[i].height);
    EXPECT_EQ(feature.at("properties").at("closed"), lines_[i].closed);
    const auto& corners = feature.at("geometry").at("coordinates");
    ASSERT_EQ(corners.size(), lines_[i].places.size() + (lines_[i].closed ? 1U : 0U));
    for (std::size_t k = 0; k < lines_[i].places.size(); ++k) {
      ASSERT_EQ(corners.at(k).size(), 2U) << "a height would have to be above the ellipsoid";
      const Eigen::Vector3d back = coordinates_.from_geodetic(
          {.latitude = corners.at(k).at(1), .longitude = corners.at(k).at(0)});
      EXPECT_LT((back.head<2>() - lines_[i].places[k]).norm(), 1e-3);
    }
  }
  EXPECT_TRUE(json.at("features").at(0).at("properties").at("index"));
  EXPECT_FALSE(json.at("features").at(1).at("properties").at("index"));
}

TEST_F(ContourFiles, GeoPackageHasALayer) {
  const test::TemporaryFolder folder;
  write_contours_geopackage(folder / "c.gpkg", sheet_);
  const SqliteDatabase database(folder / "c.gpkg", SqliteDatabase::Mode::read);
  SqliteStatement rows = database.prepare("SELECT height_m, is_index, closed FROM contours");
  std::vector<double> heights;
  while (rows.step()) {
    heights.push_back(rows.real(0));
  }
  EXPECT_EQ(heights, (std::vector{500.0, 500.5}));
  SqliteStatement system =
      database.prepare("SELECT srs_id FROM gpkg_geometry_columns WHERE table_name = 'contours'");
  ASSERT_TRUE(system.step());
  EXPECT_EQ(system.integer(0), 32632);
  const ProductCoordinates nowhere;
  write_contours_geopackage(folder / "m.gpkg",
                            {.lines = &lines_, .step = 0.5, .coordinates = &nowhere});
  const SqliteDatabase plain(folder / "m.gpkg", SqliteDatabase::Mode::read);
  SqliteStatement undefined = plain.prepare("SELECT srs_id FROM gpkg_geometry_columns");
  ASSERT_TRUE(undefined.step());
  EXPECT_EQ(undefined.integer(0), kUndefinedPlane);
}

TEST_F(ContourFiles, DxfHasLayersAndHeights) {
  const std::string dxf = contours_dxf(sheet_);
  EXPECT_NE(dxf.find("INDEX_CONTOURS"), std::string::npos);
  EXPECT_NE(dxf.find("500.5"), std::string::npos);
}

}  // namespace
}  // namespace adit
