// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The surface of a map from above, and rasters of colours.
#include "adit/tools/map_products/surface_from_above.hpp"

#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/export/export_job.hpp"
#include "adit/tools/map_products/color_raster.hpp"

namespace adit {
namespace {

constexpr double kFloor = -1.0;  // m
constexpr double kTable = -0.3;

int32_t steps(double metres) {
  return static_cast<int32_t>(metres * kSubmapSteps);
}

/// A floor of 10 by 10 m, a table of 2 by 2 m on it, and a ceiling, seen from their middle.
class FromAbove : public testing::Test {
 protected:
  FromAbove() {
    MapDatabase map(file_, MapAccess::write);
    const SessionId session = map.add_session({.name = "room"});
    KeyframeSubmap submap;
    submap.r_submap = 0.25;
    submap.vertical = Vertical::gravity;
    submap.sweeps = {{.stamp = std::chrono::seconds(1), .merged = true}};
    for (int x = -20; x < 20; ++x) {
      for (int y = -20; y < 20; ++y) {
        const Eigen::Vector2d at = 0.25 * Eigen::Vector2d(x + 0.5, y + 0.5);
        const bool table = (at - Eigen::Vector2d(3.0, 3.0)).cwiseAbs().maxCoeff() < 1.0;
        const bool person = (at - Eigen::Vector2d(-3.0, 3.0)).cwiseAbs().maxCoeff() < 0.5;
        for (const double z : {kFloor, 1.5}) {
          submap.points.push_back({.place = {steps(at.x()), steps(at.y()), steps(z)}});
        }
        if (table) {
          submap.points.push_back({.place = {steps(at.x()), steps(at.y()), steps(kTable)}});
        }
        if (person) {
          submap.points.push_back(
              {.place = {steps(at.x()), steps(at.y()), steps(-0.1)}, .seen_through = true});
        }
      }
    }
    std::ranges::sort(submap.points, {}, &SubmapPoint::place);
    KeyframeRecord record{
        .keyframe = {.id = 0, .session = session, .stamp = std::chrono::seconds(1)},
        .submap = encode(submap)};
    record.keyframe.T_map_keyframe.translation() = Eigen::Vector3d(100.0, 50.0, 0.0);
    map.store(record);
  }

  std::vector<CloudPoint> surface(const ProductCoordinates& coordinates, double cell,
                                  const CloudSelection& selection = {}) const {
    const MapDatabase map(file_, MapAccess::read);
    std::vector<CloudPoint> all;
    visit_surface_from_above(map, coordinates, selection, cell, uint64_t{1} << 24U,
                             [&](const SurfacePart& part, std::size_t done, std::size_t total) {
                               EXPECT_LE(done, total);
                               all.insert(all.end(), part.points.begin(), part.points.end());
                             });
    return all;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "map.adit";
};

TEST_F(FromAbove, FloorsAndTablesAreSeenCeilingsAndWhatMovesAreNot) {
  std::map<std::pair<int64_t, int64_t>, int> places;
  for (const CloudPoint& point : surface({}, 0.1)) {
    ASSERT_EQ(point.position, point.in_map);
    const Eigen::Vector2d at = point.position.head<2>() - Eigen::Vector2d(100.0, 50.0);
    const double from_table = (at - Eigen::Vector2d(3.0, 3.0)).cwiseAbs().maxCoeff();
    if (from_table < 1.0) {
      ASSERT_NEAR(point.position.z(), kTable, 1e-3) << at.transpose();
    } else if (from_table > 1.2) {
      ASSERT_NEAR(point.position.z(), kFloor, 1e-3) << at.transpose();
    }
    ++places[{std::lround(at.x() / 0.05 - 0.5), std::lround(at.y() / 0.05 - 0.5)}];
  }
  for (int x = -100; x < 100; ++x) {
    for (int y = -100; y < 100; ++y) {
      ASSERT_EQ((places[{x, y}]), 1) << "each place of the floor once: " << x << " " << y;
    }
  }
}

TEST_F(FromAbove, OnTheEarthPlacesAreThoseOfTheMapTurned) {
  const ProductCoordinates utm(parse_origin("48.1,11.5,520,30"), ProductFrame::utm);
  const std::vector<CloudPoint> points = surface(utm, 0.5);
  EXPECT_GT(points.size(), 1000U);
  for (const CloudPoint& point : points) {
    ASSERT_LT((utm.from_map(point.in_map) - point.position).norm(), 2e-4);
  }
}

TEST_F(FromAbove, APartIsCutOutToTheCell) {
  const CloudSelection part{.polygon = {{98.0, 49.0}, {101.0, 49.0}, {101.0, 51.0}, {98.0, 51.0}}};
  EXPECT_EQ(surface({}, 0.1, part).size(), 60U * 40U);
  EXPECT_TRUE(surface({}, 0.1, {.polygon = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}}).empty());
}

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// The numbers of a field of a TIFF file as bytes.
std::string field_of(const std::string& tiff, uint16_t tag) {
  const auto begin = number_at<uint32_t>(tiff, 4);
  const auto count = number_at<uint16_t>(tiff, begin);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = begin + 2 + 12 * i;
    if (number_at<uint16_t>(tiff, at) == tag) {
      const auto type = number_at<uint16_t>(tiff, at + 2);
      const std::size_t size = type == 12 ? 8 : type == 4 ? 4 : type == 3 ? 2 : 1;
      const std::size_t bytes = size * number_at<uint32_t>(tiff, at + 4);
      return tiff.substr(bytes <= 4 ? at + 8 : number_at<uint32_t>(tiff, at + 8), bytes);
    }
  }
  ADD_FAILURE() << "no field " << tag;
  return std::string(64, '\0');
}

TEST(ColorRaster, ACellHasTheMeanOfItsPointsThatHaveAColor) {
  std::vector<CloudPoint> points(5);
  points[0] = {.position = {0.1, 0.1, 0.0}, .color = {10, 20, 31}};
  points[1] = {.position = {0.2, 0.2, 0.0}, .color = {20, 40, 60}};
  points[2] = {.position = {0.2, 0.2, 0.0}};
  points[3] = {.position = {300.5, -0.5, 0.0}, .color = {1, 2, 3}};
  points[4] = {.position = {5.5, 9.5, 0.0}};
  ColorRaster raster(1.0);
  EXPECT_TRUE(raster.empty());
  raster.add(points);
  EXPECT_EQ(raster.filled(), 2U);
  EXPECT_EQ(raster.frame().columns, 301);
  EXPECT_EQ(raster.frame().rows, 2);
  EXPECT_EQ(raster.at(0, 0), (std::array<uint8_t, 4>{15, 30, 46, 255}));
  EXPECT_EQ(raster.at(300, 1), (std::array<uint8_t, 4>{1, 2, 3, 255}));
  EXPECT_EQ(raster.at(5, 0), (std::array<uint8_t, 4>{}));

  // The file, as TIFF 6.0 and GeoTIFF 1.1 say.
  const test::TemporaryFolder folder;
  const ProductCoordinates utm(parse_origin("48.1,11.5,520"), ProductFrame::utm);
  raster.write_tiff(folder / "a.tif", utm);
  const std::string tiff = test::content(folder / "a.tif");
  EXPECT_EQ(number_at<uint32_t>(field_of(tiff, 256), 0), 301U);
  EXPECT_EQ(number_at<uint16_t>(field_of(tiff, 262), 0), 2) << "RGB";
  EXPECT_EQ(number_at<uint16_t>(field_of(tiff, 277), 0), 4);
  EXPECT_EQ(number_at<uint16_t>(field_of(tiff, 338), 0), 2) << "opacity";
  EXPECT_EQ(field_of(tiff, 258).size(), 8U);
  EXPECT_EQ(number_at<uint16_t>(field_of(tiff, 258), 6), 8);
  EXPECT_EQ(number_at<double>(field_of(tiff, 33922), 24), 0.0);
  EXPECT_EQ(number_at<double>(field_of(tiff, 33922), 32), 1.0) << "upper edge";
  const std::string keys = field_of(tiff, 34735);
  const std::string epsg = std::string("\x00\x0c\x00\x00\x01\x00\x78\x7f", 8);  // 3072: 32632
  EXPECT_NE(keys.find(epsg), std::string::npos);
  const std::string offsets = field_of(tiff, 324);
  const std::string sizes = field_of(tiff, 325);
  ASSERT_EQ(offsets.size(), 8U) << "two blocks of 256 cells";
  std::vector<uint8_t> block(std::size_t{4} * 256 * 256);
  uLongf size = block.size();
  ASSERT_EQ(
      uncompress(block.data(), &size,
                 reinterpret_cast<const Bytef*>(tiff.data()) + number_at<uint32_t>(offsets, 4),
                 number_at<uint32_t>(sizes, 4)),
      Z_OK);
  ASSERT_EQ(size, block.size());
  const std::size_t at = 4 * (256 + 300 - 256);
  EXPECT_EQ(std::vector(block.begin() + at, block.begin() + at + 4),
            (std::vector<uint8_t>{1, 2, 3, 255}));
}

}  // namespace
}  // namespace adit
