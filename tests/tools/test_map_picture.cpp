// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/map_picture.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/drawing/svg.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

TEST(MapPicture, NeighbouringCellsOfOneHeightAreOneStroke) {
  std::vector<Point> wall;
  for (int i = 0; i <= 40; ++i) {
    const float inside = i == 0 ? 0.0F : 0.02F;  // the first point is the corner of the picture
    wall.push_back(
        {.x = 0.05F * static_cast<float>(i) + inside, .y = 0.0F, .z = 1.0F, .intensity = 0.0F});
  }
  wall.push_back({.x = 0.01F, .y = 2.0F, .z = 9.0F, .intensity = 0.0F});
  const std::string picture = map_picture(wall, {});
  EXPECT_EQ(count(picture, "h41"), 1U) << picture;
  EXPECT_NE(picture.find("M0 0.5h1"), std::string::npos) << "the northern point is in the top row";
  EXPECT_EQ(picture.find("nan"), std::string::npos);
}

TEST(MapPicture, KeyframesAndLoopsAreDrawnAndNamed) {
  const std::vector<StampedPose> path(3);
  const PictureGraph graph{.keyframes = {{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}},
                           .loops = {{.from = {0.0, 0.0}, .to = {2.0, 0.0}},
                                     {.from = {0.0, 0.0}, .to = {1.0, 0.0}, .revoked = true}}};
  const std::string picture = map_picture({}, path, "A map", graph);
  const std::string plain = map_picture({}, path, "A map");
  for (const char* word : {">keyframe<", ">loop<", ">revoked<"}) {
    EXPECT_EQ(count(picture, word), 1U) << word;
    EXPECT_EQ(count(plain, word), 0U) << word;
  }
  EXPECT_EQ(count(picture, "<circle"), count(plain, "<circle") + 4) << "and one in the legend";
}

TEST(MapPicture, AnArrowPointsToNorthWhereYIsNorth) {
  const std::vector<StampedPose> path(3);
  EXPECT_EQ(count(map_picture({}, path, "A map", {.north_up = true}), ">N</text>"), 1U);
  EXPECT_EQ(count(map_picture({}, path, "A map"), ">N</text>"), 0U);
}

TEST(MapPicture, LinesOfTheGridMeetTheTicks) {
  std::vector<StampedPose> path(2);
  path[1].pose.translation() = Eigen::Vector3d(100.0, 40.0, 0.0);
  const std::string picture = map_picture({}, path);
  // 0, 10, to 100, and 0 to 40: a line, a tick and a label each.
  const auto lines_of = [&](std::string_view color) {
    return count(picture, "stroke=\"" + std::string(color) + "\" stroke-width=\"1.00\"/>\n<");
  };
  EXPECT_EQ(lines_of(kGridColor), 16U) << picture;
  EXPECT_EQ(lines_of(kAxisColor), 16U + 1U) << "and the frame";
}

TEST(MapPicture, HasTitleLegendAxesScaleAndFollowsTheReadersGround) {
  std::vector<Point> points;
  for (int i = 0; i < 400; ++i) {
    points.push_back({0.25F * static_cast<float>(i % 80), 0.5F * static_cast<float>(i / 20),
                      0.1F * static_cast<float>(i % 7), 0.0F});
  }
  const std::vector<StampedPose> path(3);
  const std::string picture = map_picture(points, path, "A hall");
  for (const char* part : {">A hall<", ">x (m)<", ">y (m)<", ">path<", ">start<", ">end<",
                           "m and higher<", "height ", "prefers-color-scheme: dark", " m</text>"}) {
    EXPECT_EQ(count(picture, part) > 0, true) << part << " in:\n" << picture.substr(0, 4000);
  }
}

TEST(MapPicture, HighestPointGivesTheColour) {
  const std::vector<Point> low{{0.0F, 0.0F, 0.0F, 0.0F}, {5.0F, 5.0F, 8.0F, 0.0F}};
  std::vector<Point> both = low;
  both.push_back({0.0F, 0.0F, 8.0F, 0.0F});
  EXPECT_NE(map_picture(low, {}), map_picture(both, {}));
  std::vector<Point> below = both;
  below.push_back({0.0F, 0.0F, -3.0F, 0.0F});
  EXPECT_EQ(map_picture(both, {}), map_picture(below, {}));
}

TEST(MapPicture, EmptyMapIsAPictureStill) {
  const std::string picture = map_picture({}, {});
  EXPECT_EQ(picture.find("nan"), std::string::npos);
  EXPECT_NE(picture.find("</svg>"), std::string::npos);
}

TEST(MapPicture, StaysSmallWhateverTheMap) {
  Random random(1);
  std::vector<Point> noise;
  for (int i = 0; i < 400'000; ++i) {
    noise.push_back({static_cast<float>(random.uniform(-900, 900)),
                     static_cast<float>(random.uniform(-900, 900)),
                     static_cast<float>(random.uniform(0, 9)), 0.0F});
  }
  EXPECT_LT(map_picture(noise, {}).size(), 3'000'000U)
      << "noise in every cell is the worst there is";
}

}  // namespace
}  // namespace adit
