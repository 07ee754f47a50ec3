// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit export` is told of places, and folders of tiles that do not become whole.
#include "adit/tools/export/export_job.hpp"

#include <filesystem>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_products/tile_folder.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

const Georeference kPlaced{.origin = {.latitude = 41.65, .longitude = -0.88, .altitude = 612.3}};

/// The message of what is thrown; empty where nothing is.
template <class Error>
std::string thrown(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ExportOrigin, IsAPlaceOfFiniteNumbers) {
  const auto refusal = [](const std::string& origin) {
    return thrown<UsageError>([&] { static_cast<void>(parse_origin(origin)); });
  };
  EXPECT_EQ(refusal("41.65,-0.88,612.3,-400"), "");
  for (const auto& [origin, part] :
       {std::pair("nan,0,0", "its latitude is nan"),
        std::pair("-84.1,0,0", "its latitude is -84.1"),
        std::pair("41,inf,0", "its longitude is inf"), std::pair("41,0,nan", "its height is nan"),
        std::pair("41,0,1e12", "its height is 1e+12"),
        std::pair("41,0,0,nan", "its yaw is no direction"),
        std::pair("41,0,0,-inf", "its yaw is no direction")}) {
    const std::string said = refusal(origin);
    EXPECT_TRUE(said.starts_with(std::string("--origin ") + origin + ": " + part)) << said;
  }
}

class ExportPolygon : public testing::Test {
 protected:
  template <class Error>
  std::string refusal(const std::string& text, const ExportJob& job,
                      const ProductCoordinates& coordinates) const {
    const ExportCommandOptions options{.polygon = folder_.write("polygon", text)};
    ExportJob with = job;
    with.options = &options;
    return thrown<Error>([&] { static_cast<void>(selection_of(with, coordinates)); });
  }

  test::TemporaryFolder folder_;
};

TEST_F(ExportPolygon, HasFiniteCorners) {
  for (const char* corner : {"1 nan", "inf 1", "-nan 2"}) {
    const std::string said = refusal<InputError>("0 0\n" + std::string(corner) + "\n3 3\n", {}, {});
    EXPECT_NE(said.find("polygon, line 2: it is no corner"), std::string::npos) << said;
  }
  const ProductCoordinates local(kPlaced, ProductFrame::local);
  for (const char* corner : {"[1e999, 0]", "[0, 95]"}) {
    const std::string said =
        refusal<InputError>(R"({"type": "Polygon", "coordinates": [[[-0.8, 41.6], [-0.8, 41.7], )" +
                                std::string(corner) + "]]}",
                            {}, local);
    EXPECT_NE(said.find("A polygon is a GeoJSON Polygon"), std::string::npos) << said;
  }
}

TEST_F(ExportPolygon, InDegreesIsForProductsInTheWorld) {
  const char* const degrees = R"({"type": "Polygon", "coordinates": [[[0, 1], [1, 1], [1, 0]]]})";
  ExportJob job;
  job.georeference = kPlaced;
  const std::string placed = refusal<UsageError>(degrees, job, {});
  EXPECT_NE(placed.find("say --frame utm or local"), std::string::npos) << placed;
  const std::string nowhere = refusal<UsageError>(degrees, {}, {});
  EXPECT_NE(nowhere.find("is in degrees: the map is not georeferenced"), std::string::npos)
      << nowhere;
}

TEST(TileFolder, WhatIsNotWholeIsRemovedAndNothingElse) {
  const test::TemporaryFolder folder;
  const fs::path tiles = folder / "tiles.part";
  const std::vector<CloudPoint> points(1);
  {
    TileFolder unfinished(tiles, CloudFormat::pcd, {}, 20.0);
    unfinished.write({}, points);
    EXPECT_TRUE(fs::exists(tiles / "pointcloud_map.pcd"));
  }
  EXPECT_FALSE(fs::exists(tiles));

  folder.write("tiles.part/pointcloud_map.pcd/0_0.pcd", "left by one that was killed");
  folder.write("tiles.part/notes.txt", "of somebody");
  { const TileFolder beside(tiles, CloudFormat::las, {}, 20.0); }
  EXPECT_FALSE(fs::exists(tiles / "tiles"));
  EXPECT_TRUE(fs::exists(tiles / "pointcloud_map.pcd"));
  TileFolder::remove(tiles);
  EXPECT_FALSE(fs::exists(tiles / "pointcloud_map.pcd"));
  EXPECT_TRUE(fs::exists(tiles / "notes.txt"));
  fs::remove(tiles / "notes.txt");
  TileFolder::remove(tiles);
  EXPECT_FALSE(fs::exists(tiles));
}

}  // namespace
}  // namespace adit
