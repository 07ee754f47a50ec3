// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit export --slice | --section | --plan` of a house whose walls are known.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/plans/mapped_house.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::Ran;
using test::ran;

constexpr double kSensor = 0.8;  // m above the floor
constexpr double kStorey = 3.4;  // m

/// A plane with this normal, as submaps keep it.
struct Line {
  Vector2d from;
  Vector2d to;
};

/// Lines of a drawing on the layer WALLS.
std::vector<Line> walls_of(const std::string& dxf) {
  std::vector<Line> lines;
  std::istringstream stream(dxf);
  std::string kind;
  for (std::string code, value; std::getline(stream, code) && std::getline(stream, value);) {
    kind = code == "0" ? value : kind;
    if (kind != "LINE") {
      continue;
    }
    if (code == "0") {
      lines.emplace_back();
    } else if (code == "10" || code == "20") {
      lines.back().from[code == "10" ? 0 : 1] = std::stod(value);
    } else if (code == "11" || code == "21") {
      lines.back().to[code == "11" ? 0 : 1] = std::stod(value);
    }
  }
  return lines;
}

/// A house of two floors of 10 x 6 m, mapped from the middle of each as the path goes along x. On
/// the ground floor something stood at (5, 1) that has moved.
class PlanExport : public testing::Test {
 protected:
  PlanExport() {
    std::vector<Vector3d> sensors;
    for (int storey = 0; storey < 2; ++storey) {
      for (int step = 0; step < 7; ++step) {
        sensors.emplace_back(2.0 + step, 3.0, storey * kStorey);
      }
    }
    test::write_house(map_, sensors, draw);
  }

  static void draw(KeyframeSubmap& submap, const Vector3d& sensor, NodeId id) {
    const double floor = sensor.z() - kSensor;
    const auto add = [&](const Vector3d& point, const Vector3d& normal, bool moved = false) {
      test::add_point(submap, sensor, point, normal, moved);
    };
    const double shift = 0.013 * static_cast<double>(id);
    for (double z = floor + 0.1; z < floor + 2.6; z += 0.06) {
      for (double x = shift; x <= 10.0; x += 0.1) {
        add({x, 0.0, z}, Vector3d::UnitY());
        add({x, 6.0, z}, -Vector3d::UnitY());
      }
      for (double y = shift; y <= 6.0; y += 0.1) {
        add({0.0, y, z}, Vector3d::UnitX());
        add({10.0, y, z}, -Vector3d::UnitX());
      }
      add({5.0, 1.0, z}, Vector3d::UnitX(), true);
    }
    for (double x = shift; x < 10.0; x += 0.1) {
      for (double y = 0.2; y < 6.0; y += 0.3) {
        add({x, y, floor}, Vector3d::UnitZ());
        add({x, y, floor + 2.7}, -Vector3d::UnitZ());
      }
    }
  }

  Ran exported(ExportCommandOptions options, const char* name) const {
    options.map = map_;
    options.output = folder_ / name;
    return ran(export_command, options);
  }
  void refuses(const ExportCommandOptions& options, const char* name, const char* what) const {
    const Ran done = exported(options, name);
    EXPECT_EQ(done.code, 2) << done.out;
    EXPECT_NE(done.err.find(what), std::string::npos) << done.err;
    EXPECT_FALSE(fs::exists(folder_ / name));
  }

  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
};

void expect_room(const std::string& dxf) {
  const std::vector<Line> walls = walls_of(dxf);
  ASSERT_EQ(walls.size(), 4U);
  double length = 0.0;
  for (const Line& wall : walls) {
    length += (wall.to - wall.from).norm();
    for (const Vector2d& end : {wall.from, wall.to}) {
      EXPECT_LT(std::min(std::abs(end.x()), std::abs(end.x() - 10.0)), 0.002);
      EXPECT_LT(std::min(std::abs(end.y()), std::abs(end.y() - 6.0)), 0.002);
    }
  }
  EXPECT_NEAR(length, 32.0, 0.01);
}

TEST_F(PlanExport, ASliceIsTheWallsWithoutWhatMoved) {
  const Ran done = exported({.slice = "0.5"}, "slice.dxf");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("4 lines, 32.0 m; 0 cells of other points"), std::string::npos)
      << done.out;
  expect_room(test::content(folder_ / "slice.dxf"));
}

TEST_F(PlanExport, ASectionHasFloorsAndCeilings) {
  const Ran done = exported({.section = "-1,2,11,2,0.8"}, "section.dxf");
  ASSERT_EQ(done.code, 0) << done.err;
  const std::vector<Line> lines = walls_of(test::content(folder_ / "section.dxf"));
  for (const double height :
       {-kSensor, 2.7 - kSensor, kStorey - kSensor, 2.7 + kStorey - kSensor}) {
    EXPECT_TRUE(std::ranges::any_of(lines, [&](const Line& line) {
      return std::abs(line.from.y() - height) < 0.01 && std::abs(line.to.y() - height) < 0.01 &&
             (line.to - line.from).norm() > 9.0;
    })) << height;
  }
  EXPECT_TRUE(std::ranges::any_of(lines, [](const Line& line) {
    return std::abs(line.from.x() - 1.0) < 0.01 && std::abs(line.to.x() - 1.0) < 0.01;
  })) << "x is counted from the first end";
}

TEST_F(PlanExport, EachStoreyHasItsPlan) {
  const Ran done = exported({.plan = true}, "plan.dxf");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("plan_0.dxf (floor at -0.80 m"), std::string::npos) << done.out;
  EXPECT_NE(done.out.find("plan_1.dxf (floor at 2.60 m"), std::string::npos) << done.out;
  expect_room(test::content(folder_ / "plan_0.dxf"));
  expect_room(test::content(folder_ / "plan_1.dxf"));
  EXPECT_FALSE(fs::exists(folder_ / "plan.dxf"));
  EXPECT_FALSE(fs::exists(folder_ / "plan_2.dxf"));
}

TEST_F(PlanExport, ABoxCropsThePlanAndNotTheSearchForStoreys) {
  const Ran done = exported({.box = "-1,-1,4,4", .plan = true}, "plan.dxf");
  ASSERT_EQ(done.code, 0) << done.err;
  const std::vector<Line> walls = walls_of(test::content(folder_ / "plan_1.dxf"));
  ASSERT_EQ(walls.size(), 2U);
  for (const Line& wall : walls) {
    EXPECT_NEAR((wall.to - wall.from).norm(), 4.0, 0.1);
  }
}

TEST_F(PlanExport, RastersAndPicturesAreOfTheSameSlice) {
  ASSERT_EQ(exported({.cell = 0.1, .slice = "0.5,0.3"}, "slice.tif").code, 0);
  const std::string tiff = test::content(folder_ / "slice.tif");
  EXPECT_EQ(tiff.substr(0, 2), "II");
  EXPECT_NE(tiff.find("number of points"), std::string::npos);
  ASSERT_EQ(exported({.slice = "0.5"}, "slice.svg").code, 0);
  EXPECT_NE(test::content(folder_ / "slice.svg").find(">Plan at 0.5 m<"), std::string::npos);
}

/// A value of the file beside a grid's picture.
std::string yaml_value(const std::string& yaml, const std::string& key) {
  const std::size_t at = yaml.find(key + ": ");
  EXPECT_NE(at, std::string::npos) << key;
  const std::size_t begin = at + key.size() + 2;
  return yaml.substr(begin, yaml.find('\n', begin) - begin);
}

// The rule of nav2_map_server's mode `trinary`: how dark a pixel is decides, and only if
// free_thresh is at most 0.196 the unknown ones (205) are not free.
TEST_F(PlanExport, AGridIsWhatNavigationReadsWithoutWhatMoved) {
  ASSERT_EQ(exported({.grid = true, .cell = 0.1}, "grid.yaml").code, 0);
  const std::string yaml = test::content(folder_ / "grid.yaml");
  const std::string picture = test::content(folder_ / yaml_value(yaml, "image"));
  EXPECT_EQ(yaml_value(yaml, "mode"), "trinary");
  EXPECT_EQ(yaml_value(yaml, "negate"), "0");
  const double cell = std::stod(yaml_value(yaml, "resolution"));
  std::istringstream corner(yaml_value(yaml, "origin").substr(1));
  Vector2d origin;
  char comma = ' ';
  corner >> origin.x() >> comma >> origin.y();
  std::istringstream head(picture);
  std::string kind;
  std::ptrdiff_t columns = 0;
  std::ptrdiff_t rows = 0;
  head >> kind >> columns >> rows;
  ASSERT_EQ(kind, "P5");
  const std::size_t begin = picture.size() - static_cast<std::size_t>(columns * rows);
  const auto at = [&](double x, double y) {
    const auto column = static_cast<std::ptrdiff_t>(std::floor((x - origin.x()) / cell));
    const auto row = rows - 1 - static_cast<std::ptrdiff_t>(std::floor((y - origin.y()) / cell));
    const auto pixel = static_cast<unsigned char>(
        picture[begin + static_cast<std::size_t>(row * columns + column)]);
    const double dark = (255.0 - pixel) / 255.0;
    return dark > std::stod(yaml_value(yaml, "occupied_thresh")) ? 100
           : dark < std::stod(yaml_value(yaml, "free_thresh"))   ? 0
                                                                 : -1;
  };
  EXPECT_EQ(at(3.05, 0.001), 100);
  EXPECT_EQ(at(3.05, 6.05), 100);
  EXPECT_EQ(at(5.0, 3.0), 0);
  EXPECT_EQ(at(5.0, 1.0), 0) << "what stood there has moved";
}

TEST_F(PlanExport, TheGroundHasContoursAndARaster) {
  ASSERT_EQ(exported({.raster = "ground", .cell = 0.25}, "ground.tif").code, 0);
  EXPECT_NE(test::content(folder_ / "ground.tif").find("height of the ground"), std::string::npos);
  // Both floors are flat, 0.8 m below the sensor: a line is nowhere but at multiples of the step.
  const Ran flat = exported({.contours = 0.5}, "contours.dxf");
  EXPECT_EQ(flat.code, 2) << flat.out;
  EXPECT_NE(flat.err.find("the ground reaches no multiple of it"), std::string::npos) << flat.err;
  refuses({.contours = 0.5}, "p.svg", "contour lines are DXF, GeoJSON or GeoPackage files");
  refuses({.from = 1e6, .contours = 0.5}, "p.dxf", "no ground was seen");
  refuses({.elevation = true}, "p.png", "an elevation map is a GeoTIFF");
  ASSERT_EQ(exported({.elevation = true}, "elevation.tif").code, 0);
  EXPECT_NE(test::content(folder_ / "elevation.tif").find("description\">step_height<"),
            std::string::npos);
}

TEST_F(PlanExport, AreTheSameBytesTwice) {
  for (const char* name : {"a.dxf", "a.svg", "a.tif"}) {
    ASSERT_EQ(exported({.slice = "0.5"}, name).code, 0);
    const std::string once = test::content(folder_ / name);
    ASSERT_EQ(exported({.slice = "0.5"}, name).code, 0);
    EXPECT_EQ(test::content(folder_ / name), once) << name;
  }
}

TEST_F(PlanExport, SayWhatCannotBe) {
  refuses({.slice = "40"}, "p.dxf", "--slice 40: no points at that height; the points are from");
  refuses({.slice = "nan"}, "p.dxf", "expected HEIGHT or HEIGHT,THICKNESS");
  refuses({.slice = "1,2,3"}, "p.dxf", "expected HEIGHT or HEIGHT,THICKNESS");
  refuses({.slice = "1,0"}, "p.dxf", "more than 0 m thick");
  refuses({.slice = "1,inf"}, "p.dxf", "expected HEIGHT");
  refuses({.section = "0,0,0"}, "p.dxf", "expected X0,Y0,X1,Y1");
  refuses({.section = "1,1,1,1"}, "p.dxf", "both ends are at one place");
  refuses({.section = "50,50,60,50"}, "p.dxf", "no points along that line");
  refuses({.section = "0,0,1,1"}, "p.tif", "a section is upright");
  refuses({.slice = "0.5"}, "p.pdf", "name it *.dxf, *.svg or *.tif");
  refuses({.cell = 0.1, .slice = "0.5"}, "p.dxf", "--cell needs");
  refuses({.slice = "0.5", .plan = true}, "p.dxf", "say what to export");
  refuses({.without_moving = true, .slice = "0.5"}, "p.dxf", "leave out what moves anyway");
  refuses({.box = "50,50,60,60", .plan = true}, "p.dxf", "no points 1.2 m above any floor");
  EXPECT_FALSE(fs::exists(folder_ / "p_0.dxf"));
  refuses({.until = 101.0, .plan = true}, "p.dxf", "keeps to no floor for 5 m");
}

}  // namespace
}  // namespace adit
