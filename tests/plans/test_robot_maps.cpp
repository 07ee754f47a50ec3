// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps that robots plan in: the occupancy grid of two rooms, and the elevation map of a ramp.
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <queue>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/plans/mapped_house.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/plans/elevation_map.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::ran;

/// A map as nav2's map_server reads it: YAML, and a PGM whose first row has the highest y.
struct NavigationMap {
  std::map<std::string, std::string> keys{};
  double resolution = 0.0;
  Vector2d origin = Vector2d::Zero();
  int columns = 0;
  int rows = 0;
  std::string pixels{};

  explicit NavigationMap(const fs::path& file) {
    std::istringstream lines(test::content(file));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t colon = line.find(": ");
      keys[line.substr(0, colon)] = line.substr(colon + 2);
    }
    resolution = std::stod(keys.at("resolution"));
    std::istringstream corner(keys.at("origin").substr(1));
    char comma = ' ';
    corner >> origin.x() >> comma >> origin.y();
    const std::string picture = test::content(file.parent_path() / keys.at("image"));
    std::istringstream head(picture);
    std::string kind;
    head >> kind >> columns >> rows;
    pixels = picture.substr(picture.size() - static_cast<std::size_t>(columns * rows));
  }

  bool is_free(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) {
      return false;
    }
    const auto pixel = static_cast<unsigned char>(
        pixels[static_cast<std::size_t>((rows - 1 - row) * columns + column)]);
    return (255.0 - pixel) / 255.0 < std::stod(keys.at("free_thresh"));
  }
  std::array<int, 2> cell(const Vector2d& p) const {
    return {static_cast<int>(std::floor((p.x() - origin.x()) / resolution)),
            static_cast<int>(std::floor((p.y() - origin.y()) / resolution))};
  }
};

/// A* for a disc of this radius (m): the path's places, empty where there is none.
std::vector<Vector2d> planned(const NavigationMap& map, const Vector2d& from, const Vector2d& to,
                              double radius) {
  using Cell = std::array<int, 2>;
  const int reach = static_cast<int>(std::ceil(radius / map.resolution));
  const auto fits = [&](const Cell& at) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        if (std::hypot(x, y) * map.resolution <= radius && !map.is_free(at[0] + x, at[1] + y)) {
          return false;
        }
      }
    }
    return true;
  };
  const Cell goal = map.cell(to);
  const auto rest = [&](const Cell& at) { return std::hypot(at[0] - goal[0], at[1] - goal[1]); };
  std::map<Cell, double> costs = {{map.cell(from), 0.0}};
  std::map<Cell, Cell> parents;
  std::priority_queue<std::pair<double, Cell>, std::vector<std::pair<double, Cell>>, std::greater<>>
      open;
  open.push({rest(map.cell(from)), map.cell(from)});
  std::set<Cell> closed;
  while (!open.empty()) {
    const Cell at = open.top().second;
    open.pop();
    if (at == goal) {
      std::vector<Vector2d> path;
      for (Cell cell = at; cell != map.cell(from); cell = parents.at(cell)) {
        path.emplace_back(map.origin + map.resolution * Vector2d(cell[0] + 0.5, cell[1] + 0.5));
      }
      return path;
    }
    if (!closed.insert(at).second) {
      continue;
    }
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const Cell next = {at[0] + x, at[1] + y};
        const double cost = costs.at(at) + std::hypot(x, y);
        const auto known = costs.find(next);
        if ((known == costs.end() || cost < known->second) && fits(next)) {
          costs[next] = cost;
          parents[next] = at;
          open.push({cost + rest(next), next});
        }
      }
    }
  }
  return {};
}

/// Two rooms of 5 x 6 m with a wall of 0.1 m between them, in it a door of `door` (m) around y = 3;
/// a walker stood in the door for a while.
void write_two_rooms(const fs::path& file, double door) {
  std::vector<Vector3d> sensors;
  for (int step = 0; step < 9; ++step) {
    sensors.emplace_back(1.0 + step, 3.0, 0.0);
  }
  const auto draw = [door](KeyframeSubmap& submap, const Vector3d& sensor, NodeId id) {
    const double shift = 0.006 * static_cast<double>(id);
    const bool is_left = sensor.x() < 5.0;
    const double low = is_left ? 0.0 : 5.05;
    const double high = is_left ? 4.95 : 10.0;
    for (const double z : {-0.2, 0.0, 0.2}) {
      for (double x = low + shift; x <= high; x += 0.05) {
        test::add_point(submap, sensor, {x, 0.0, z}, Vector3d::UnitY());
        test::add_point(submap, sensor, {x, 6.0, z}, -Vector3d::UnitY());
      }
      for (double y = shift; y <= 6.0; y += 0.05) {
        test::add_point(submap, sensor, {is_left ? 0.0 : 10.0, y, z},
                        (is_left ? 1.0 : -1.0) * Vector3d::UnitX());
        if (std::abs(y - 3.0) > 0.5 * door) {
          test::add_point(submap, sensor, {is_left ? 4.95 : 5.05, y, z},
                          (is_left ? -1.0 : 1.0) * Vector3d::UnitX());
        }
      }
      for (double y = 2.9; y < 3.1; y += 0.05) {
        test::add_point(submap, sensor, {5.0, y, z}, Vector3d::UnitX(), true);
      }
    }
    // Of the other room what is seen through the door.
    const auto sees = [&](const Vector3d& point) {
      const double share = (5.0 - sensor.x()) / (point.x() - sensor.x());
      return std::abs(sensor.y() + share * (point.y() - sensor.y()) - 3.0) < 0.5 * door - 0.02;
    };
    for (double x = 10.0 - high + shift; x <= 10.0 - low; x += 0.05) {
      for (const Vector3d& point : {Vector3d(x, 0.0, 0.0), Vector3d(x, 6.0, 0.0)}) {
        if (sees(point)) {
          test::add_point(submap, sensor, point, Vector3d::UnitY());
        }
      }
    }
    for (double y = shift; y <= 6.0; y += 0.05) {
      if (const Vector3d point(is_left ? 10.0 : 0.0, y, 0.0); sees(point)) {
        test::add_point(submap, sensor, point, Vector3d::UnitX());
      }
    }
    for (double x = low + shift; x <= high; x += 0.1) {
      for (double y = 0.1; y < 6.0; y += 0.1) {
        test::add_point(submap, sensor, {x, y, -0.6}, Vector3d::UnitZ());
      }
    }
  };
  test::write_house(file, sensors, draw);
}

TEST(OccupancyGridFile, IsWhatMapServerReads) {
  const test::TemporaryFolder folder;
  write_two_rooms(folder / "map.adit", 1.0);
  const ExportCommandOptions options{
      .map = folder / "map.adit", .output = folder / "rooms.yaml", .grid = true};
  ASSERT_EQ(ran(export_command, options).code, 0);
  const NavigationMap map(folder / "rooms.yaml");
  // All keys that nav2_map_server's loadMapYaml() requires, and `mode`.
  std::set<std::string> names;
  for (const auto& [name, value] : map.keys) {
    names.insert(name);
  }
  EXPECT_EQ(names, (std::set<std::string>{"free_thresh", "image", "mode", "negate",
                                          "occupied_thresh", "origin", "resolution"}));
  EXPECT_EQ(map.keys.at("mode"), "trinary");
  EXPECT_EQ(map.keys.at("negate"), "0");
  EXPECT_LT(std::stod(map.keys.at("free_thresh")), std::stod(map.keys.at("occupied_thresh")));
  EXPECT_EQ(map.resolution, 0.05);
  // 254 is free, 0 occupied, 205 neither: (255 - 205) / 255 = 0.1961 lies between the thresholds.
  for (const char pixel : map.pixels) {
    const auto value = static_cast<unsigned char>(pixel);
    EXPECT_TRUE(value == 0 || value == 205 || value == 254) << int{value};
  }
  EXPECT_TRUE(map.is_free(map.cell({2.0, 2.0})[0], map.cell({2.0, 2.0})[1]));
  EXPECT_FALSE(map.is_free(map.cell({2.0, 6.02})[0], map.cell({2.0, 6.02})[1]));
}

TEST(OccupancyGridFile, APlannerGoesThroughTheDoorAndNoWall) {
  for (const double door : {1.0, 0.4}) {
    const test::TemporaryFolder folder;
    write_two_rooms(folder / "map.adit", door);
    const ExportCommandOptions options{
        .map = folder / "map.adit", .output = folder / "rooms.yaml", .grid = true};
    ASSERT_EQ(ran(export_command, options).code, 0);
    const NavigationMap map(folder / "rooms.yaml");
    const std::vector<Vector2d> path = planned(map, {1.0, 1.0}, {9.0, 5.0}, 0.3);
    EXPECT_EQ(path.empty(), door < 0.6) << "a robot of 0.6 m, and a door of " << door;
    double least = 1e9;
    for (const Vector2d& place : path) {
      least = std::min(least, std::abs(place.x() - 5.0));
      EXPECT_TRUE(std::abs(place.x() - 5.0) > 0.1 || std::abs(place.y() - 3.0) < 0.3);
      EXPECT_TRUE(place.x() > 0.2 && place.x() < 9.8 && place.y() > 0.2 && place.y() < 5.8);
    }
    EXPECT_TRUE(path.empty() || least < 0.1) << "it crosses the wall's line";
  }
}

/// Flat to x = 0, then a ramp of 20 degrees, on flat ground a kerb of 0.15 m along y = 4, and a
/// post.
TEST(ElevationMap, HasSlopesStepsAndWhatStandsThere) {
  const double ramp = std::tan(20.0 * 3.14159265358979 / 180.0);
  const auto height = [&](double x, double y) {
    return x > 0.0 ? ramp * x : (y > 4.0 ? 0.15 : 0.0);
  };
  GroundSearch search(0.25);
  std::vector<PlanPoint> points;
  for (double x = -5.96; x < 6.0; x += 0.08) {
    for (double y = -5.96; y < 6.0; y += 0.08) {
      points.push_back({.position = {x, y, height(x, y)}, .normal = Vector3d::UnitZ()});
    }
  }
  for (double z = 0.05; z < 3.0; z += 0.05) {
    points.push_back({.position = {-3.1, -3.1, z}, .normal = Vector3d::UnitX()});
  }
  search.add(points);
  const std::vector<FloorStep> steps(1, {.sensor = {-5.0, -5.0, 0.8}, .floor = 0.0});
  const GroundPlanes planes(search.levels_from(steps), 0.25);
  ElevationMap map(planes, 0.25);
  map.add(points);
  const ElevationLayers layers = map.layers();
  const auto at = [&](const GroundHeights& layer, double x, double y) {
    return layer.at(layer.index_of({x, y})).value_or(-1.0);
  };
  EXPECT_NEAR(at(layers.slope, -3.0, 0.0), 0.0, 0.1);
  EXPECT_NEAR(at(layers.slope, 3.0, 0.0), 20.0, 1.0);
  EXPECT_NEAR(at(layers.elevation, 3.1, 0.1), ramp * 3.125, 0.02);
  EXPECT_NEAR(at(layers.step_height, -3.0, 4.1), 0.15, 0.05);
  EXPECT_NEAR(at(layers.step_height, -3.0, 1.0), 0.0, 1e-6);
  EXPECT_NEAR(at(layers.obstacle_height, -3.1, -3.1), kHeadroom, 0.06);
  EXPECT_EQ(at(layers.obstacle_height, -2.0, -3.1), 0.0);
  EXPECT_LT(at(layers.roughness, -3.0, 0.0), 1e-6);
  EXPECT_LT(at(layers.variance, -3.0, 0.0), 1e-9);
}

}  // namespace
}  // namespace adit
