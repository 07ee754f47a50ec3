// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit export` of a map that is placed on the Earth: all products agree to a millimetre.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/export/export_job.hpp"
#include "adit/tools/map_products/cloud_raster.hpp"
#include "adit/tools/map_products/g2o_file.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Ran;
using test::ran;

constexpr double kMillimetre = 1e-3;
constexpr NodeId kKeyframes = 4;
constexpr std::size_t kPoints = 300;  // a keyframe
constexpr Nanoseconds kBegin{1'700'000'000'250'000'000};
const std::string kOrigin = "41.65,-0.88,612.3,30";

template <class T>
T load(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

struct ReadLas {
  std::vector<Eigen::Vector3d> positions;
  std::vector<double> times;
  std::vector<int> classes;
  std::vector<uint32_t> keyframes;
};

ReadLas read_las_exactly(const fs::path& file) {
  const std::string bytes = test::content(file);
  ReadLas las;
  const auto count = load<uint64_t>(bytes, 247);
  const auto begin = load<uint32_t>(bytes, 96);
  const auto size = load<uint16_t>(bytes, 105);
  EXPECT_EQ(bytes.size(), begin + count * size);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = begin + i * size;
    Eigen::Vector3d p;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p[static_cast<Eigen::Index>(axis)] =
          load<int32_t>(bytes, at + 4 * axis) * load<double>(bytes, 131 + 8 * axis) +
          load<double>(bytes, 155 + 8 * axis);
      EXPECT_LE(p[static_cast<Eigen::Index>(axis)], load<double>(bytes, 179 + 16 * axis));
      EXPECT_GE(p[static_cast<Eigen::Index>(axis)], load<double>(bytes, 187 + 16 * axis));
    }
    las.positions.push_back(p);
    las.classes.push_back(load<uint8_t>(bytes, at + 16));
    las.times.push_back(load<double>(bytes, at + 22));
    las.keyframes.push_back(load<uint32_t>(bytes, at + 32));
  }
  return las;
}

/// Rows of a CSV file by the names of their columns.
std::vector<std::map<std::string, std::string>> read_csv(const fs::path& file) {
  std::ifstream stream(file);
  const auto cells = [&]() {
    std::vector<std::string> parts;
    std::string line;
    std::getline(stream, line);
    std::istringstream words(line);
    for (std::string part; std::getline(words, part, ',');) {
      parts.push_back(part);
    }
    return parts;
  };
  const std::vector<std::string> names = cells();
  std::vector<std::map<std::string, std::string>> rows;
  for (std::vector<std::string> row = cells(); !row.empty(); row = cells()) {
    EXPECT_EQ(row.size(), names.size());
    for (rows.emplace_back(); const std::string& name : names) {
      rows.back()[name] = row[rows.back().size()];
    }
  }
  return rows;
}

/// A map of a few keyframes, 40 m apart, that climbs and turns; every tenth point has moved.
class MapProducts : public testing::Test {
 protected:
  MapProducts() {
    MapDatabase map(map_, MapAccess::write);
    const SessionId session = map.add_session({.name = "first"});
    std::mt19937 random(7);
    std::uniform_int_distribution<int32_t> wide(-20 * 2048, 20 * 2048);
    for (NodeId id = 0; id < kKeyframes; ++id) {
      KeyframeSubmap submap;
      submap.r_submap = 0.25;
      submap.vertical = Vertical::gravity;
      const Nanoseconds stamp = kBegin + std::chrono::milliseconds(1000 * id);
      submap.sweeps = {{.stamp = stamp, .merged = true},
                       {.stamp = stamp + std::chrono::milliseconds(100), .merged = true}};
      submap.sweeps[1].T_keyframe_lidar.translation() = Eigen::Vector3d(0.8, 0.1, 0.0);
      for (std::size_t i = 0; i < kPoints; ++i) {
        submap.points.push_back({.place = {wide(random), wide(random), wide(random) / 8},
                                 .sweep = static_cast<uint16_t>(i % 2),
                                 .seen_through = i % 10 == 0});
      }
      std::ranges::sort(submap.points, {}, &SubmapPoint::place);
      const double n = static_cast<double>(id);
      const Eigen::Isometry3d pose = Eigen::Translation3d(40.0 * n, 3.0 * n, 0.5 * n) *
                                     Eigen::AngleAxisd(0.3 * n, Eigen::Vector3d::UnitZ());
      KeyframeRecord record{
          .keyframe = {.id = id, .session = session, .stamp = stamp, .T_map_keyframe = pose},
          .submap = encode(submap)};
      if (id > 0) {
        record.edges.push_back({.from = id - 1, .to = id, .T_from_to = last_.inverse() * pose});
      }
      last_ = pose;
      map.store(record);
    }
  }

  fs::path exported(ExportCommandOptions options, const char* name) {
    options.map = map_;
    options.output = folder_ / name;
    const Ran done = ran(export_command, options);
    EXPECT_EQ(done.code, 0) << done.err;
    said_ = done.out;
    return folder_ / name;
  }
  void refuses(ExportCommandOptions options, const char* what, int code = 2) {
    options.map = map_;
    options.output = options.output ? options.output : folder_ / "refused";
    const Ran done = ran(export_command, options);
    EXPECT_EQ(done.code, code) << done.out;
    EXPECT_NE(done.err.find(what), std::string::npos) << done.err;
    EXPECT_FALSE(fs::exists(*options.output));
  }
  /// Each point of the map in UTM, by the projections themselves.
  std::vector<Eigen::Vector3d> truth() const {
    const MapDatabase map(map_, MapAccess::read);
    const Georeference placed = parse_origin(kOrigin);
    const WorldFrame world(placed.origin);
    std::vector<Eigen::Vector3d> places;
    for (const MapKeyframe& keyframe : map.keyframes()) {
      for (const SubmapPoint& point : decode(map.submap(keyframe.id)).points) {
        const Geodetic place =
            world.place_of(placed.T_world_map * (keyframe.T_map_keyframe * point.position()));
        const UtmPosition utm = utm_of(place, UtmZone{30, true});
        places.emplace_back(utm.easting, utm.northing, place.altitude);
      }
    }
    return places;
  }

  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
  std::string said_;
  Eigen::Isometry3d last_ = Eigen::Isometry3d::Identity();
};

TEST(ProductCoordinates, UtmIsInterpolatedToAMicrometre) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> metres(-12000.0, 12000.0);
  for (const Geodetic& origin : {Geodetic{0.0, 9.0, 0.0}, Geodetic{41.65, -0.88, 612.3},
                                 Geodetic{-60.0, 149.99, 30.0}, Geodetic{70.0, 5.9, 100.0}}) {
    const ProductCoordinates coordinates({.origin = origin}, ProductFrame::utm);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d p(metres(random), metres(random), 0.01 * metres(random));
      const PlaceOnEarth place = coordinates.place(p);
      const Eigen::Vector3d exact(place.utm.easting, place.utm.northing, place.geodetic.altitude);
      EXPECT_LT((coordinates.from_map(p) - exact).norm(), 1e-6) << origin.latitude;
    }
  }
}

TEST(ProductCoordinates, AxesOfAPoseTurnWithTheGrid) {
  Georeference placed{.origin = {60.0, 7.0, 100.0}};
  placed.T_world_map = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
  const ProductCoordinates coordinates(placed, ProductFrame::utm, {.zone = UtmZone{32, true}});
  const Eigen::Isometry3d pose =
      Eigen::Translation3d(3000.0, -2000.0, 5.0) * Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ());
  const Eigen::Isometry3d in_utm = coordinates.from_map(pose);
  const Eigen::Vector3d ahead =
      coordinates.from_map(Eigen::Vector3d(pose * Eigen::Vector3d(10.0, 0.0, 0.0)));
  const Eigen::Vector3d seen = in_utm.inverse() * ahead;
  EXPECT_NEAR(seen.x(), 10.0, 0.01) << "UTM is scaled";
  EXPECT_NEAR(seen.y(), 0.0, 1e-4);
}

TEST_F(MapProducts, AreInANamedSystem) {
  const std::vector<Eigen::Vector3d> expected = truth();
  const fs::path file =
      exported({.cloud = "las", .crs = "EPSG:32630", .origin = kOrigin}, "named.las");
  EXPECT_NE(said_.find("UTM zone 30N"), std::string::npos) << said_;
  const ReadLas las = read_las_exactly(file);
  ASSERT_EQ(las.positions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_LT((las.positions[i] - expected[i]).norm(), kMillimetre);
  }
  for (const auto& row : read_csv(
           exported({.trajectory = "csv", .crs = "EPSG:25830", .origin = kOrigin}, "named.csv"))) {
    EXPECT_NEAR(std::stod(row.at("crs_east_m")), std::stod(row.at("easting_m")), kMillimetre);
    EXPECT_NEAR(std::stod(row.at("crs_north_m")), std::stod(row.at("northing_m")), kMillimetre);
  }
  exported({.trajectory = "gpkg", .crs = "EPSG:2154", .origin = kOrigin}, "named.gpkg");
  EXPECT_NE(said_.find("Lambert-93"), std::string::npos) << said_;
  refuses({.cloud = "las", .crs = "EPSG:1", .origin = kOrigin}, "knows no coordinate");
  refuses({.cloud = "las", .crs = "EPSG:28356", .origin = kOrigin}, "does not cover");
  refuses({.cloud = "las", .crs = "EPSG:25830"}, "not georeferenced");
  refuses({.cloud = "las", .frame = "utm", .crs = "EPSG:25830", .origin = kOrigin}, "exclude");
  refuses({.trajectory = "kml", .crs = "EPSG:25830", .origin = kOrigin}, "geodetic");
  refuses({.cloud = "las", .geoid = folder_ / "none.pgm", .origin = kOrigin}, "geoid");
  refuses({.cloud = "ply", .frame = "local", .geoid = map_, .origin = kOrigin}, "exclude");
  refuses({.trajectory = "gpkg", .geoid = map_, .origin = kOrigin}, "above the ellipsoid");
}

TEST_F(MapProducts, AgreeToAMillimetre) {
  const std::vector<Eigen::Vector3d> expected = truth();
  const ReadLas las = read_las_exactly(exported({.cloud = "las", .origin = kOrigin}, "cloud.las"));
  EXPECT_NE(said_.find("UTM zone 30N"), std::string::npos) << said_;
  ASSERT_EQ(las.positions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_LT((las.positions[i] - expected[i]).norm(), kMillimetre);
  }
  EXPECT_EQ(std::ranges::count(las.classes, 64), kKeyframes * static_cast<int>(kPoints) / 10);
  EXPECT_EQ(las.keyframes.back(), kKeyframes - 1);
  EXPECT_NEAR(las.times.front(), adjusted_gps_time(kBegin), 0.101);

  // Single precision, less an offset that the header tells.
  for (const char* format : {"ply", "pcd"}) {
    const fs::path file = exported({.cloud = format, .frame = "utm", .origin = kOrigin}, format);
    const std::string text = test::content(file);
    Eigen::Vector3d offset;
    std::istringstream(text.substr(text.find("offset: ") + 8)) >> offset.x() >> offset.y() >>
        offset.z();
    const auto points =
        (format == std::string("ply") ? read_ply(file) : read_pcd(file)).sweep.points;
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p = offset + Eigen::Vector3d(points[i].x, points[i].y, points[i].z);
      ASSERT_LT((p - expected[i]).norm(), kMillimetre);
    }
  }

  // The raster's highest points are those of the cloud, moving ones apart.
  const MapDatabase map(map_, MapAccess::read);
  const ProductCoordinates utm(parse_origin(kOrigin), ProductFrame::utm);
  CloudRaster raster(RasterValue::height, 2.0);
  visit_cloud(map, utm, {}, [&](std::span<const CloudPoint> points) { raster.add(points); });
  std::map<std::pair<int64_t, int64_t>, double> highest;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (las.classes[i] == 1) {
      const Eigen::Vector2d cell = (expected[i].head<2>() - raster.frame().corner) / 2.0;
      const std::pair<int64_t, int64_t> place{std::lround(std::floor(cell.x())),
                                              std::lround(std::floor(-cell.y()))};
      const auto known = highest.try_emplace(place, expected[i].z());
      known.first->second = std::max(known.first->second, expected[i].z());
    }
  }
  EXPECT_EQ(raster.filled(), highest.size());
  for (const auto& [place, z] : highest) {
    ASSERT_NEAR(raster.at(place.first, place.second), z, kMillimetre);
  }

  // Trajectory and graph.
  const auto rows = read_csv(exported({.trajectory = "csv", .origin = kOrigin}, "t.csv"));
  const auto tum =
      read_trajectory(exported({.trajectory = "tum", .frame = "utm", .origin = kOrigin}, "t.tum"));
  const PoseGraph graph =
      read_g2o(exported({.graph = "g2o", .frame = "utm", .origin = kOrigin}, "g.g2o")).graph;
  exported({.trajectory = "gpkg", .frame = "utm", .origin = kOrigin}, "t.gpkg");
  const SqliteDatabase package(folder_ / "t.gpkg", SqliteDatabase::Mode::read);
  SqliteStatement points = package.prepare("SELECT geom FROM keyframes ORDER BY fid");
  ASSERT_EQ(rows.size(), 2 * kKeyframes);
  ASSERT_EQ(tum.poses.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto number = [&](const char* name) { return std::stod(rows[i].at(name)); };
    const Eigen::Vector3d p(number("easting_m"), number("northing_m"), number("altitude_m"));
    EXPECT_EQ(rows[i].at("utm_zone"), "30N");
    EXPECT_LT((tum.poses[i].pose.translation() - p).norm(), kMillimetre);
    const UtmPosition back =
        utm_of({number("latitude_deg"), number("longitude_deg"), 0.0}, UtmZone{30, true});
    EXPECT_LT(std::hypot(back.easting - p.x(), back.northing - p.y()), kMillimetre);
    EXPECT_NEAR(back.convergence * kDegreesPerRadian, number("convergence_deg"), 1e-7);
    if (i % 2 == 0) {  // a keyframe's first sweep is where the keyframe is
      EXPECT_LT((graph.nodes()[i / 2].T_map_node.translation() - p).norm(), kMillimetre);
      ASSERT_TRUE(points.step());
      const std::span<const std::byte> blob = points.blob(0);
      ASSERT_EQ(blob.size(), 8U + 5U + 24U);
      Eigen::Vector3d point;
      std::memcpy(point.data(), blob.data() + 13, 24);
      EXPECT_LT((point - p).norm(), kMillimetre);
    }
  }
}

TEST_F(MapProducts, LinesAndPointsAreWhatOthersExpect) {
  const auto json = test::json_of(exported({.trajectory = "geojson", .origin = kOrigin}, "t.json"));
  EXPECT_EQ(json.at("features").size(), 1U + kKeyframes);
  const auto& line = json.at("features")[0].at("geometry");
  EXPECT_EQ(line.at("type"), "LineString");
  EXPECT_NEAR(line.at("coordinates")[0][0].get<double>(), -0.88, 1e-9);
  EXPECT_NEAR(line.at("coordinates")[0][1].get<double>(), 41.65, 1e-9);
  EXPECT_NEAR(line.at("coordinates")[0][2].get<double>(), 612.3, 1e-4);
  const std::string kml =
      test::content(exported({.trajectory = "kml", .origin = kOrigin}, "t.kml"));
  EXPECT_EQ(test::count(kml, "<gx:coord>"), 2U * kKeyframes);
  EXPECT_NE(kml.find("<when>2023-11-14T22:13:20.250Z</when>"), std::string::npos) << kml;
}

TEST_F(MapProducts, TilesHoldAllPointsOnceAndAreThoseOfAutoware) {
  fs::create_directories(folder_ / "tiles.part/pointcloud_map.pcd");  // of one that was killed
  const fs::path folder = exported({.tiles = 20.0, .origin = kOrigin}, "tiles");
  std::size_t points = 0;
  std::size_t tiles = 0;
  const std::string metadata = test::content(folder / "pointcloud_map_metadata.yaml");
  EXPECT_TRUE(metadata.starts_with("x_resolution: 20.0\ny_resolution: 20.0\n"));
  for (const auto& entry : fs::directory_iterator(folder / "pointcloud_map.pcd")) {
    const std::string name = entry.path().filename().string();
    const std::size_t at = metadata.find("\n" + name + ": [");
    ASSERT_NE(at, std::string::npos) << name;
    double x = 0.0;
    double y = 0.0;
    char comma = ' ';
    std::istringstream(metadata.substr(at + name.size() + 4)) >> x >> comma >> y;
    for (const Point& point : read_pcd(entry.path()).sweep.points) {
      EXPECT_TRUE(point.x > x - kMillimetre && point.x < x + 20.0 + kMillimetre) << name;
      EXPECT_TRUE(point.y > y - kMillimetre && point.y < y + 20.0 + kMillimetre) << name;
      ++points;
    }
    ++tiles;
  }
  EXPECT_EQ(points, kKeyframes * kPoints);
  EXPECT_GT(tiles, 8U);
  EXPECT_EQ(test::lines(folder / "tiles.csv"), tiles + 1);
  const std::string projector = test::content(folder / "map_projector_info.yaml");
  EXPECT_NE(projector.find("projector_type: LocalCartesianUTM\nvertical_datum: WGS84\n"
                           "map_origin:\n  latitude: 41.65\n  longitude: -0.88\n"
                           "  altitude: 612.3\n"),
            std::string::npos)
      << projector;
  EXPECT_EQ(
      test::count(test::content(exported({.tiles = 50.0}, "unplaced") / "map_projector_info.yaml"),
                  "projector_type: Local\n"),
      1U);
  refuses({.tiles = 1.5}, "whole number");
}

TEST_F(MapProducts, RastersSayWhereTheyLie) {
  const std::string tiff =
      test::content(exported({.origin = kOrigin, .raster = "height", .cell = 0.5}, "height.tif"));
  EXPECT_TRUE(tiff.starts_with(std::string("II*\0", 4)));
  const auto directory = load<uint32_t>(tiff, 4);
  std::map<uint16_t, uint32_t> fields;
  for (std::size_t i = 0; i < load<uint16_t>(tiff, directory); ++i) {
    const std::size_t at = directory + 2 + 12 * i;
    fields[load<uint16_t>(tiff, at)] = load<uint32_t>(tiff, at + 8);
  }
  exported({.origin = kOrigin, .raster = "height", .cell = 0.5}, "height.png");
  std::ifstream world(folder_ / "height.pgw");
  double cell = 0.0;
  double zero = 0.0;
  double down = 0.0;
  Eigen::Vector2d middle;
  world >> cell >> zero >> zero >> down >> middle.x() >> middle.y();
  EXPECT_EQ(cell, 0.5);
  EXPECT_EQ(down, -0.5);
  EXPECT_EQ(load<double>(tiff, fields[33922] + 24), middle.x() - 0.25);
  EXPECT_EQ(load<double>(tiff, fields[33922] + 32), middle.y() + 0.25);
  EXPECT_NE(tiff.find("UTM zone 30N"), std::string::npos);

  exported({.grid = true, .cell = 0.5}, "grid.yaml");
  EXPECT_NE(test::content(folder_ / "grid.yaml").find("image: grid.pgm\nmode: trinary\n"),
            std::string::npos);
  const std::string pgm = test::content(folder_ / "grid.pgm");
  EXPECT_GT(std::ranges::count(pgm, '\0'), 20);
  EXPECT_GT(std::ranges::count(pgm, static_cast<char>(254)), 500);
}

TEST_F(MapProducts, AReportNamesWhatIsToBeWatched) {
  const std::string placed =
      test::content(exported({.origin = kOrigin, .report = true}, "report.html"));
  for (const char* part : {"WGS 84 / UTM zone 30N", "41.650000000, -0.880000000 degrees",
                           "1200, of which 120 moved", "placed by hand", "<svg", "North is up"}) {
    EXPECT_NE(placed.find(part), std::string::npos) << part;
  }
  const std::string unplaced = test::content(exported({.report = true}, "report.html"));
  EXPECT_NE(unplaced.find("has no place on the Earth"), std::string::npos);
  refuses({.output = folder_ / "r.pdf", .report = true}, "*.html");
}

TEST_F(MapProducts, ArePartsWhereSomebodyAsksForParts) {
  const std::vector<Eigen::Vector3d> all = truth();
  const auto points = [&](ExportCommandOptions options) {
    options.cloud = "las";
    options.origin = kOrigin;
    return read_las_exactly(exported(options, "part.las")).positions.size();
  };
  const Eigen::Vector3d middle = all.front();
  const auto in_box =
      static_cast<std::size_t>(std::ranges::count_if(all, [&](const Eigen::Vector3d& p) {
        return std::abs(p.x() - middle.x()) < 10.0 && std::abs(p.y() - middle.y()) < 10.0;
      }));
  EXPECT_EQ(points({.box = fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}", middle.x() - 10.0,
                                       middle.y() - 10.0, middle.x() + 10.0, middle.y() + 10.0)}),
            in_box);
  const ProductCoordinates utm(parse_origin(kOrigin), ProductFrame::utm);
  std::string corners;
  std::string text;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-10, -10), Eigen::Vector2d(10, -10),
                                        Eigen::Vector2d(10, 10), Eigen::Vector2d(-10, 10)}) {
    const Eigen::Vector2d p = middle.head<2>() + corner;
    const Geodetic place = place_of({.zone = 30, .easting = p.x(), .northing = p.y()}, 0.0);
    corners += fmt::format("{}[{:.12f}, {:.12f}]", corners.empty() ? "" : ", ", place.longitude,
                           place.latitude);
    text += fmt::format("{:.6f} {:.6f}  # a corner\n", p.x(), p.y());
  }
  EXPECT_EQ(points({.polygon = folder_.write("p.txt", text)}), in_box);
  EXPECT_EQ(points({.polygon = folder_.write(
                        "p.json", R"({"type": "Feature", "properties": {}, "geometry": {"type": )"
                                  R"("Polygon", "coordinates": [[)" +
                                      corners + "]]}}")}),
            in_box);
  EXPECT_EQ(points({.sessions = {1}}), all.size());
  EXPECT_EQ(points({.from = 1'700'000'001.0, .until = 1'700'000'002.0}), kPoints);
  EXPECT_EQ(points({.without_moving = true}), all.size() - all.size() / 10);
  EXPECT_LT(points({.resolution = 8.0}), all.size() / 4);
}

TEST_F(MapProducts, SayWhatCannotBe) {
  refuses({.trajectory = "kml"}, "not georeferenced");
  refuses({.cloud = "las", .frame = "utm"}, "--origin LAT,LON,ALT");
  refuses({.cloud = "las", .origin = "41.65"}, "expected LAT,LON,ALT");
  refuses({.cloud = "las", .origin = "91,0,0"}, "latitudes within 84");
  refuses({.cloud = "las", .utm = "30X", .origin = kOrigin}, "such as 30N");
  refuses({.cloud = "las", .utm = "1N", .origin = kOrigin}, "does not cover the map's place");
  refuses({.trajectory = "csv", .frame = "utm", .origin = kOrigin}, "all frames");
  refuses({.cloud = "ply", .frame = "geodetic", .origin = kOrigin}, "degrees are for");
  refuses({.cloud = "ply", .box = "1,2,0,4"}, "X0 < X1");
  refuses({.cloud = "ply", .sessions = {7}}, "no such session");
  refuses({.graph = "g2o", .without_moving = true}, "are for points");
  refuses({.graph = "g2o", .find_moving = true}, "--find-moving is for points, grids and reports");
  refuses({.output = folder_ / "r.jpg", .raster = "height"}, "*.tif or *.png");
  refuses({.output = folder_ / "g.png", .grid = true}, "*.yaml");
  refuses({.output = folder_ / "g.yaml", .grid = true, .heights = "1,0"}, "LOW < HIGH");
  refuses({.cloud = "ply", .polygon = folder_.write("two.txt", "0 0\n1 1\n")}, "has 2 corners", 1);
  refuses({.cloud = "ply", .polygon = folder_.write("no.txt", "0 0\n1 x\n")}, "line 2", 1);
}

TEST_F(MapProducts, RefuseWhatWouldHaveNoEffect) {
  const fs::path tif = folder_ / "r.tif";
  const fs::path svg = folder_ / "p.svg";
  const fs::path page = folder_ / "r.html";
  const char* nowhere = "--utm 30N: the map is not georeferenced";
  refuses({.cloud = "las", .utm = "30N"}, nowhere);
  refuses({.cloud = "ply", .utm = "30N"}, nowhere);
  refuses({.tiles = 20.0, .utm = "30N"}, nowhere);
  refuses({.output = tif, .utm = "30N", .raster = "height"}, nowhere);
  refuses({.trajectory = "csv", .utm = "30N"}, nowhere);
  refuses({.trajectory = "csv", .frame = "geodetic"}, "--frame geodetic: the map is not");
  refuses({.trajectory = "kml", .utm = "30N", .origin = kOrigin}, "kml is geodetic");
  refuses({.output = svg, .picture = true, .utm = "30N"}, "--utm: pictures and dumps");
  refuses({.output = svg, .picture = true, .origin = kOrigin}, "--origin: pictures and dumps");
  refuses({.cloud = "ply", .origin = kOrigin}, "say --frame local or utm");
  refuses({.cloud = "las", .frame = "map", .origin = kOrigin}, "say --frame local or utm");
  refuses({.output = page, .frame = "map", .origin = kOrigin, .report = true},
          "--frame map: a rep");
  refuses({.dense = "las", .without_moving = true}, "of single returns it is not known");
  refuses({.output = tif, .without_moving = true, .raster = "height"},
          "rasters and plans leave out");
  refuses({.cloud = "ply", .from = 2.0, .until = 1.0}, "--from is later than --until");
  refuses({.output = folder_ / "g.yaml", .until = 1.0, .grid = true}, "--grid: no point is within");
}

TEST_F(MapProducts, AreTheSameBytesTwice) {
  for (const char* name : {"gpkg", "geojson", "kml", "csv"}) {
    const std::string once = test::content(exported({.trajectory = name, .origin = kOrigin}, "a"));
    EXPECT_EQ(test::content(exported({.trajectory = name, .origin = kOrigin}, "b")), once) << name;
  }
  const std::string once = test::content(exported({.cloud = "las", .origin = kOrigin}, "a"));
  EXPECT_EQ(test::content(exported({.cloud = "las", .origin = kOrigin}, "b")), once);
}

}  // namespace
}  // namespace adit
