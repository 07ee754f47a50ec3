// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Drawings for CAD programs and to print: structure, units, scale.
#include "adit/tools/plans/plan_drawing.hpp"

#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/drawing/dxf_drawing.hpp"

namespace adit {
namespace {

using Group = std::pair<int, std::string>;

/// The pairs of code and value that DXF is made of.
std::vector<Group> groups_of(const std::string& dxf) {
  std::vector<Group> groups;
  std::istringstream lines(dxf);
  for (std::string code, value; std::getline(lines, code);) {
    EXPECT_TRUE(static_cast<bool>(std::getline(lines, value))) << "a code without a value";
    EXPECT_EQ(code.find_first_not_of("0123456789"), std::string::npos) << code;
    groups.emplace_back(std::atoi(code.c_str()), value);
  }
  return groups;
}

/// What follows a variable of the header.
std::vector<std::string> variable(const std::vector<Group>& groups, const std::string& name) {
  std::vector<std::string> values;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] == Group(9, name)) {
      for (++i; i < groups.size() && groups[i].first != 9 && groups[i].first != 0; ++i) {
        values.push_back(groups[i].second);
      }
    }
  }
  return values;
}

PlanSheet sheet() {
  PlanSheet sheet{.title = "Plan at 1.2 m"};
  sheet.lines.walls = {{.from = {0.0, 0.0}, .to = {8.0, 0.0}},
                       {.from = {8.0, 0.0}, .to = {8.0, 5.0}}};
  sheet.lines.rest = {{2.025, 2.025}, {2.075, 2.025}, {4.025, 3.025}};
  return sheet;
}

TEST(PlanDrawing, DxfHasUnitsExtentsAndLayers) {
  const std::string dxf = plan_dxf(sheet());
  const std::vector<Group> groups = groups_of(dxf);
  EXPECT_EQ(groups.back(), Group(0, "EOF"));
  EXPECT_EQ(variable(groups, "$ACADVER"), std::vector<std::string>{"AC1015"});
  EXPECT_EQ(variable(groups, "$INSUNITS"), std::vector<std::string>{"6"});  // metres
  EXPECT_EQ(variable(groups, "$EXTMIN"), (std::vector<std::string>{"0.0000", "0.0000", "0.0000"}));
  EXPECT_EQ(variable(groups, "$EXTMAX"), (std::vector<std::string>{"8.0000", "5.0000", "0.0000"}));
  std::map<std::string, int> entities;  // by kind and layer
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] == Group(0, "LINE") || groups[i] == Group(0, "POINT")) {
      ++entities[groups[i].second + " " + groups[i + 4].second];
    }
  }
  EXPECT_EQ(entities, (std::map<std::string, int>{{"LINE WALLS", 2}, {"POINT POINTS", 3}}));
}

TEST(PlanDrawing, HandlesAreUniqueAndBelowTheNext) {
  DxfDrawing drawing({{.name = "A"}, {.name = "B"}}, "two\nlines");
  for (int i = 0; i < 1000; ++i) {
    drawing.point("A", {0.1 * i, -0.1 * i});
  }
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {1, 0}, {1, 1}};
  drawing.polyline("B", corners, true, 2.5);
  const std::vector<Group> groups = groups_of(drawing.str());
  EXPECT_EQ(groups.front(), Group(999, "two lines"));
  const unsigned long next = std::stoul(variable(groups, "$HANDSEED").at(0), nullptr, 16);
  std::set<unsigned long> handles;
  std::string kind;
  std::size_t begins = 0;
  std::size_t ends = 0;
  for (const auto& [code, value] : groups) {
    kind = code == 0 ? value : kind;
    begins += code == 0 && (value == "SECTION" || value == "TABLE" || value == "BLOCK");
    ends += code == 0 && (value == "ENDSEC" || value == "ENDTAB" || value == "ENDBLK");
    // Of a table's entry for dimensions the code is another, since 5 was taken.
    if (code == (kind == "DIMSTYLE" ? 105 : 5)) {
      const unsigned long handle = std::stoul(value, nullptr, 16);
      EXPECT_TRUE(kind == "HEADER" || handle == next || handles.insert(handle).second) << value;
      EXPECT_LE(handle, next);
    }
  }
  EXPECT_EQ(begins, ends);
  EXPECT_GT(handles.size(), 1020U);
}

TEST(PlanDrawing, SvgIsToScale) {
  const std::string svg = plan_svg(sheet());
  EXPECT_NE(svg.find(">1:20<"), std::string::npos);  // 8 m are 400 mm
  // 8 m at 1:20 are 400 mm, or 400 * 96 / 25.4 px.
  EXPECT_NE(svg.find("x1=\"60.00\""), std::string::npos);
  EXPECT_NE(svg.find("x2=\"1571.81\""), std::string::npos);
  EXPECT_NE(svg.find("M0 20.5h2"), std::string::npos) << "two cells that touch are a run";
  EXPECT_EQ(svg.find(">N<"), std::string::npos);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  PlanSheet north = sheet();
  north.north_up = true;
  north.title = "a < b & c";
  const std::string on_earth = plan_svg(north);
  EXPECT_NE(on_earth.find(">N<"), std::string::npos);
  EXPECT_NE(on_earth.find("a &lt; b &amp; c"), std::string::npos);
}

TEST(PlanDrawing, ALargePlanHasASmallerScale) {
  PlanSheet large = sheet();
  large.lines.walls.push_back({.from = {0.0, 0.0}, .to = {150.0, 60.0}});
  EXPECT_NE(plan_svg(large).find(">1:200<"), std::string::npos);
  PlanSheet dot{.title = "one point"};
  dot.lines.rest = {{5.0, 5.0}};
  EXPECT_NE(plan_svg(dot).find("1:20"), std::string::npos);
}

}  // namespace
}  // namespace adit
