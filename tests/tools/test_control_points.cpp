// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_edits/control_points.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/control_survey.hpp"
#include "adit/tests/support/error_text.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_info.hpp"
#include "adit/tools/commands/command_optimize.hpp"
#include "adit/tools/map_database/map_recovery.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr const char* kHead = "name,role,x_m,y_m,z_m,latitude_deg,longitude_deg,altitude_m\n";

TEST(ControlPoints, ATableIsReadByTheNamesOfItsColumns) {
  const test::TemporaryFolder folder;
  const auto file =
      folder.write("points.csv",
                   "# marked in the viewer\r\n"
                   "role, z_m, y_m, x_m, name, altitude_m, longitude_deg, "
                   "latitude_deg, sigma_m, sigma_up_m\r\n"
                   "check, 3, 2, 1, pillar 4, 500.5, 11.25, 48.5, 0.01, 0.05\r\n\r\n");
  const std::vector<MarkedPoint> points = read_control(file, {});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].point.name, "pillar 4");
  EXPECT_EQ(points[0].point.role, ControlRole::check);
  EXPECT_EQ(points[0].p_map, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(points[0].point.place.latitude, 48.5);
  EXPECT_EQ(points[0].point.place.altitude, 500.5);
  EXPECT_EQ(points[0].point.sigma, Eigen::Vector3d(0.01, 0.01, 0.05));
  EXPECT_EQ(points[0].line, 3U);
}

TEST(ControlPoints, PlacesMayBeInAZoneOfUtm) {
  const test::TemporaryFolder folder;
  const Geodetic place{.latitude = 48.5, .longitude = 11.25, .altitude = 500.5};
  const UtmPosition utm = utm_of(place, UtmZone{.zone = 32});
  const auto file =
      folder.write("points.csv", fmt::format("name,role,x_m,y_m,z_m,easting_m,northing_m,height_m\n"
                                             "A,control,0,0,0,{:.9f},{:.9f},500.5\n",
                                             utm.easting, utm.northing));
  const std::vector<MarkedPoint> points = read_control(file, {.zone = UtmZone{.zone = 32}});
  EXPECT_NEAR(points[0].point.place.latitude, place.latitude, 1e-12);
  EXPECT_NEAR(points[0].point.place.longitude, place.longitude, 1e-12);
  EXPECT_EQ(points[0].point.place.altitude, 500.5);
  const std::string error =
      test::error_of<InputError>([&] { static_cast<void>(read_control(file, {})); });
  EXPECT_NE(error.find("line 1: places are in metres. Say of which system: --utm 32N"),
            std::string::npos)
      << error;
}

TEST(ControlPoints, WhatIsWrongIsNamedWithItsLine) {
  const std::string head = kHead;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "it has no points"},
      {head, "it has no points"},
      {"name,role,x_m,y_m\n", "line 1: there is no column z_m"},
      {"name,role,x_m,y_m,z_m\n", "line 1: there are no columns for the points' places"},
      {head + "A,control,1,2,3,48,11\n", "line 2: the line has 7 cells, the first line 8"},
      {head + "A,control,1,2,x,48,11,500\n", "line 2: z_m is 'x', expected a number"},
      {head + "A,control,1,2,nan,48,11,500\n", "line 2: z_m is 'nan', expected a number"},
      {head + "A,ground,1,2,3,48,11,500\n", "line 2: the role is 'ground'"},
      {head + ",control,1,2,3,48,11,500\n", "line 2: the point has no name"},
      {head + "A,control,1,2,3,98,11,500\n", "line 2: there is no such latitude"},
      {head + "A,control,1,2,3,48,11,500\nA,check,1,2,3,48,11,500\n",
       "line 3: the name 'A' is there twice"},
  };
  const test::TemporaryFolder folder;
  for (const auto& [text, expected] : cases) {
    const auto file = folder.write("points.csv", text);
    const std::string error =
        test::error_of<InputError>([&] { static_cast<void>(read_control(file, {})); });
    EXPECT_NE(error.find(expected), std::string::npos) << error;
  }
  // Cut off anywhere: an error, or points that are whole.
  const std::string whole = test::Survey().table();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto file = folder.write("cut.csv", whole.substr(0, size));
    try {
      for (const MarkedPoint& point : read_control(file, {})) {
        EXPECT_TRUE(point.p_map.allFinite() && std::isfinite(point.point.place.altitude));
      }
    } catch (const InputError& error) {
      EXPECT_FALSE(error.remedy().empty());
    }
  }
}

test::Ran adjusted(const OptimizeCommandOptions& options) {
  return test::ran(optimize_command, options);
}

TEST(ControlPoints, TheCommandAdjustsAMapAndTheReportShowsIt) {
  const test::TemporaryFolder folder;
  const auto map = folder / "map.adit";
  test::store_surveyed(map);
  const auto table = folder.write("points.csv", test::Survey().table());
  const test::Ran ran = adjusted({.input = map, .control = table, .json = true});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_FALSE(json.at("/control/was_placed"_json_pointer).get<bool>());
  EXPECT_EQ(json.at("/control/points"_json_pointer).size(), 9U);
  const double before = json.at("/control/check/before/horizontal_rmse_m"_json_pointer);
  const double after = json.at("/control/check/after/horizontal_rmse_m"_json_pointer);
  EXPECT_LT(after, 0.1 * before);

  // Once adjusted it stays so, also for whoever optimises it without the table, or with it again:
  // marks are of the map as it was.
  EXPECT_EQ(adjusted({.input = map}).code, 0);
  const test::Ran again = adjusted({.input = map, .control = table, .json = true});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_NEAR(
      nlohmann::json::parse(again.out).at("/control/check/after/horizontal_rmse_m"_json_pointer),
      after, 1e-5);

  const test::Ran report =
      test::ran(export_command,
                ExportCommandOptions{.map = map, .output = folder / "report.html", .report = true});
  ASSERT_EQ(report.code, 0) << report.err;
  const std::string page = read_text_file(folder / "report.html");
  for (const char* part : {"Ground control", "by ground control", "<td>C0</td><td>control</td>",
                           "check points</dt><dd>4; rmse"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  const test::Ran info = test::ran(info_command, InfoCommandOptions{.map = map});
  for (const char* part : {"place      46.49", "control    5 points, rms level 0.0",
                           "check      4 points, rms level 0.0"}) {
    EXPECT_NE(info.out.find(part), std::string::npos) << part << " in " << info.out;
  }
  const MapRecovery recovered = recover_map(map, folder / "recovered.adit");
  EXPECT_TRUE(recovered.problems.empty());
  EXPECT_EQ(MapDatabase(folder / "recovered.adit", MapAccess::read).control_points().size(), 9U);
}

TEST(ControlPoints, TheCommandTellsPeople) {
  const test::TemporaryFolder folder;
  const auto map = folder / "map.adit";
  test::store_surveyed(map);
  test::Survey survey;
  survey.marks.resize(5);  // no check points
  const auto table = folder.write("points.csv", survey.table());
  const test::Ran ran = adjusted({.input = map, .control = table});
  ASSERT_EQ(ran.code, 0) << ran.err;
  for (const char* part : {"the map had no place on the Earth", "of 5 control points: level 0.0",
                           "there are no check points", "its place on the Earth and the points"}) {
    EXPECT_NE(ran.out.find(part), std::string::npos) << part << " in " << ran.out;
  }
  survey.marks[1].mistake = {30.0, 0.0, 0.0};
  const std::string before = test::dump_of(MapDatabase(map, MapAccess::read));
  const test::Ran wrong =
      adjusted({.input = map, .control = folder.write("wrong.csv", survey.table())});
  EXPECT_EQ(wrong.code, 1);
  EXPECT_NE(wrong.err.find("the others do not agree with C5"), std::string::npos) << wrong.err;
  EXPECT_EQ(test::dump_of(MapDatabase(map, MapAccess::read)), before);
  const test::Ran nowhere =
      adjusted({.input = map,
                .control = folder.write(
                    "far.csv", std::string(kHead) + "A,control,1,900,0,46.5,8.25,1200\n")});
  EXPECT_EQ(nowhere.code, 1);
  EXPECT_NE(nowhere.err.find("far.csv, line 2: the map has nothing at 1.000, 900.000, 0.000"),
            std::string::npos)
      << nowhere.err;
  EXPECT_EQ(adjusted({.input = map, .utm = "32N"}).code, 2);
  EXPECT_EQ(adjusted({.input = map, .control = table, .utm = "99N"}).code, 2);
  EXPECT_EQ(adjusted({.input = map, .output = folder / "o.g2o", .control = table}).code, 2);
}

}  // namespace
}  // namespace adit
