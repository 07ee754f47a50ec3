// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit export --classify | --clean` of a house whose floors are known, and of a simulated room.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/plans/mapped_house.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/plans/ground_planes.hpp"
#include "adit/tools/simulator/simulation.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::Ran;
using test::ran;

constexpr double kSensorHeight = 0.8;  // m above the floor
constexpr double kStoreyHeight = 3.4;  // m
constexpr int kSteps = 5;              // keyframes a storey

/// A plane with this normal, as submaps keep it.
struct ReadPoints {
  std::vector<double> heights{};  ///< m
  std::vector<int> classes{};

  std::ptrdiff_t of(int wanted) const { return std::ranges::count(classes, wanted); }
};

template <class T>
T load(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

ReadPoints read_las_points(const fs::path& file) {
  const std::string bytes = test::content(file);
  ReadPoints points;
  const auto size = load<uint16_t>(bytes, 105);
  for (std::size_t at = load<uint32_t>(bytes, 96); at + size <= bytes.size(); at += size) {
    points.heights.push_back(load<int32_t>(bytes, at + 8) * 0.001 + load<double>(bytes, 171));
    points.classes.push_back(load<uint8_t>(bytes, at + 16));
  }
  return points;
}

/// Two floors of 6 x 4 m with a wall, a table and a ceiling. In the middle of the path one keyframe
/// saw a point in the air of each floor, and one below the lower one.
class HouseCloud : public testing::Test {
 protected:
  HouseCloud() {
    std::vector<Vector3d> sensors;
    for (int step = 0; step < 2 * kSteps; ++step) {
      sensors.emplace_back(1.0 + step % kSteps, 1.0, (step / kSteps) * kStoreyHeight);
    }
    test::write_house(map_, sensors,
                      [this](KeyframeSubmap& submap, const Vector3d& sensor, NodeId id) {
                        draw(submap, sensor, id);
                      });
  }

  void draw(KeyframeSubmap& submap, const Vector3d& sensor, NodeId id) {
    const double floor = sensor.z() - kSensorHeight;
    const auto add = [&](const Vector3d& point, const Vector3d& normal) {
      test::add_point(submap, sensor, point, normal);
    };
    for (double x = 0.05; x < 6.0; x += 0.1) {
      for (double y = 0.05; y < 4.0; y += 0.1) {
        const bool table = x > 4.0 && x < 5.0 && y > 2.5 && y < 3.5;
        add({x, y, table ? floor + 0.75 : floor}, Vector3d::UnitZ());
        add({x, y, floor + 2.7}, -Vector3d::UnitZ());
        ground_ += table ? 0U : 1U;
      }
      for (double z = floor + 0.15; z < floor + 2.6; z += 0.1) {
        add({x, 4.0, z}, -Vector3d::UnitY());
      }
    }
    if (id % kSteps == 2) {
      add({1.0, 2.0, floor + 1.6}, Vector3d::UnitZ());
      if (id == 2) {
        add({2.0, 2.0, floor - 0.9}, Vector3d::UnitZ());
      }
    }
    points_ += submap.points.size();
  }

  Ran exported(ExportCommandOptions options, const char* name) const {
    options.map = map_;
    options.output = folder_ / name;
    return ran(export_command, options);
  }
  ReadPoints las(const ExportCommandOptions& options) const {
    const Ran done = exported(options, "out.las");
    EXPECT_EQ(done.code, 0) << done.err;
    return read_las_points(folder_ / "out.las");
  }

  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
  std::size_t points_ = 0;
  std::size_t ground_ = 0;
};

TEST_F(HouseCloud, FloorsOfBothStoreysAreGroundAndNothingElse) {
  const ReadPoints plain = las({.cloud = "las"});
  EXPECT_EQ(plain.of(1), static_cast<std::ptrdiff_t>(points_));
  const ReadPoints points = las({.cloud = "las", .classify = true});
  EXPECT_EQ(points.heights, plain.heights);
  EXPECT_EQ(points.of(2), static_cast<std::ptrdiff_t>(ground_));
  EXPECT_EQ(points.of(1), static_cast<std::ptrdiff_t>(points_ - ground_));
  for (std::size_t i = 0; i < points.classes.size(); ++i) {
    const double floor = points.heights[i] < 2.0 ? -kSensorHeight : kStoreyHeight - kSensorHeight;
    EXPECT_EQ(points.classes[i] == 2, std::abs(points.heights[i] - floor) < 0.1);
  }
}

TEST_F(HouseCloud, PointsThatAreAloneAreNoise) {
  const ReadPoints points = las({.cloud = "las", .classify = true, .clean = "mark"});
  EXPECT_EQ(points.of(7), 1);
  EXPECT_EQ(points.of(18), 2);
  EXPECT_EQ(points.of(2), static_cast<std::ptrdiff_t>(ground_));
  const ReadPoints alone = las({.cloud = "las", .clean = "mark"});
  EXPECT_EQ(alone.of(7), 1);
  EXPECT_EQ(alone.of(2), 0) << "nobody asked for it";
  const Ran done = exported({.cloud = "las", .clean = "drop"}, "out.las");
  EXPECT_NE(done.out.find("; 3 noise and 0 moving left out"), std::string::npos) << done.out;
  EXPECT_EQ(read_las_points(folder_ / "out.las").of(1), static_cast<std::ptrdiff_t>(points_ - 3));
}

TEST_F(HouseCloud, ThinnedCloudsAndTilesHaveTheSameClasses) {
  const ReadPoints thin =
      las({.cloud = "las", .resolution = 0.1, .classify = true, .clean = "drop"});
  EXPECT_EQ(thin.of(2), static_cast<std::ptrdiff_t>(ground_) / kSteps);
  EXPECT_EQ(thin.of(18) + thin.of(7), 0);
  ExportCommandOptions options{.cloud = "las", .tiles = 3.0};
  options.classify = true;
  const Ran done = exported(options, "tiles");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("; " + std::to_string(ground_) + " ground"), std::string::npos)
      << done.out;
}

TEST_F(HouseCloud, PlyAndPcdHaveAClassWhereItIsAskedFor) {
  for (const std::string name : {"ply", "pcd"}) {
    ASSERT_EQ(exported({.cloud = name}, "plain").code, 0);
    EXPECT_EQ(test::content(folder_ / "plain").find("classification"), std::string::npos);
    ASSERT_EQ(exported({.cloud = name, .classify = true}, "classes").code, 0);
    const std::string bytes = test::content(folder_ / "classes");
    EXPECT_NE(bytes.find("classification"), std::string::npos);
    std::size_t ground = 0;
    for (std::size_t at = bytes.size() - 17 * points_; at < bytes.size(); at += 17) {
      ground += bytes[at + 16] == 2 ? 1U : 0U;
    }
    EXPECT_EQ(ground, ground_) << name;
  }
}

TEST_F(HouseCloud, OtherExportsHaveNoClasses) {
  for (const ExportCommandOptions& options :
       {ExportCommandOptions{.classify = true, .raster = "height"},
        ExportCommandOptions{.clean = "drop", .raster = "height"}}) {
    const Ran done = exported(options, "out.tif");
    EXPECT_EQ(done.code, 2);
    EXPECT_NE(done.err.find("is for clouds: --cloud, --dense, --tiles."), std::string::npos)
        << done.err;
  }
}

TEST(GroundPlanes, FollowASlopeAndIgnoreTheFootOfAWall) {
  GroundLevels levels;
  for (int64_t y = 0; y < 20; ++y) {
    for (int64_t x = 0; x < 20; ++x) {
      const double foot = x == 19 ? 0.25 : 0.0;
      levels[{y, x}] = {0.25 * (0.3 * static_cast<double>(x) + 0.15) + foot};
    }
  }
  const GroundPlanes ground(levels, 0.25);
  for (double x = 0.1; x < 4.9; x += 0.3) {
    EXPECT_NEAR(*ground.height_above({x, 2.4, 0.3 * x + 1.0}), 1.0, 0.02) << x;
  }
  EXPECT_TRUE(ground.is_ground({2.0, 2.0, 0.65}));
  EXPECT_FALSE(ground.is_ground({2.0, 2.0, 0.75}));
  EXPECT_TRUE(ground.is_below({2.0, 2.0, 0.4}));
  EXPECT_NEAR(*ground.height_above({-0.6, 2.0, -0.18}), 0.0, 0.02) << "three cells beyond";
  EXPECT_FALSE(ground.height_above({-1.3, 2.0, 0.0}));
  EXPECT_FALSE(GroundPlanes({}, 0.25).height_above({0.0, 0.0, 0.0}));
}

TEST(SimulatedRoom, ItsFloorIsFound) {
  const test::TemporaryFolder folder;
  SimulationOptions simulation;
  simulation.scene = "room";
  simulation.trajectory = "walk";
  simulation.duration = 2.0;
  simulation.seed = 7121;
  simulation.picture = false;
  simulation.output = folder / "room.mcap";
  simulate(simulation, {});
  RunCommandOptions run;
  run.recording = simulation.output;
  run.output = folder / "out";
  run.config.overrides = {"mapping.loops=false"};
  ASSERT_EQ(ran(run_command, run).code, 0);
  ExportCommandOptions options{.map = folder / "out", .output = folder / "out.las"};
  options.dense = "las";
  options.classify = true;
  ASSERT_EQ(ran(export_command, options).code, 0);
  const ReadPoints points = read_las_points(folder / "out.las");
  const std::string surfaces = test::content(SimulationFiles(simulation.output).surfaces);
  ASSERT_EQ(points.classes.size(), surfaces.size());
  std::array<std::array<double, 2>, 2> counts{};  // by truth and class
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const bool floor = static_cast<unsigned char>(surfaces[i]) == (kLevelSurface | 1U);  // concrete
    counts.at(floor ? 1 : 0).at(points.classes[i] == 2 ? 1 : 0) += 1.0;
  }
  EXPECT_GT(counts[1][1], 0.7 * (counts[1][0] + counts[1][1])) << "of the floor, after 2 s";
  EXPECT_LT(counts[0][1], 0.03 * (counts[0][0] + counts[0][1])) << "of what is no floor";
}

}  // namespace
}  // namespace adit
