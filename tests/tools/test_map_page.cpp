// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/map_page.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tools/drawing/map_page_script.hpp"
#include "adit/tools/results/page_cloud.hpp"

namespace adit {
namespace {

/// By the definition of RFC 4648.
std::vector<uint8_t> decoded(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<uint8_t> bytes;
  uint32_t bits = 0;
  int held = 0;
  for (const char letter : text) {
    if (letter == '=') {
      break;
    }
    bits = bits << 6U | static_cast<uint32_t>(letters.find(letter));
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(static_cast<uint8_t>(bits >> static_cast<unsigned>(held)));
    }
  }
  return bytes;
}

nlohmann::json data_of(const std::string& page) {
  const std::string begin = "id=\"data\">";
  const std::size_t at = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
}

PagePose pose_at(double x, const std::string& state) {
  return {.time = x, .p = {x, 0.0, 0.0}, .state = state, .registration = "converged", .imu = ""};
}

TEST(MapPage, HoldsItsPointsToTheStepOfSixteenBits) {
  MapPage page{.title = "a", .headline = "b", .points = {}, .poses = {pose_at(0.0, "tracking")}};
  for (int i = 0; i < 100; ++i) {
    page.points.push_back(
        {.p = Eigen::Vector3f(-50.0F + static_cast<float>(i), 0.37F * static_cast<float>(i), 3.0F),
         .intensity = static_cast<float>(i),
         .pose = 0});
  }
  const nlohmann::json points = data_of(map_page(page)).at("points");
  const std::vector<uint8_t> bytes = decoded(points.at("places"));
  ASSERT_EQ(bytes.size(), 600U);
  const double step = points.at("step");
  EXPECT_NEAR(step, 99.0 / 65535.0, 1e-6);
  for (std::size_t i = 0; i < 100; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = 2 * (3 * i + k);
      const double value =
          points.at("low").at(k).get<double>() + step * (bytes[at] + 256 * bytes[at + 1]);
      EXPECT_NEAR(value, static_cast<double>(page.points[i].p[static_cast<Eigen::Index>(k)]),
                  0.6 * step);
    }
  }
  const std::vector<uint8_t> intensity = decoded(points.at("intensity"));
  EXPECT_EQ(intensity.front(), 0);
  EXPECT_EQ(intensity.back(), 255);
}

TEST(MapPage, StandsAloneWhateverItsTextsAre) {
  const std::string hostile = "</script><img src=\"http://example.org/x\">&\xff";
  const MapPage page{.title = hostile,
                     .headline = hostile,
                     .points = {},
                     .poses = {pose_at(0.0, hostile), pose_at(std::nan(""), "tracking")}};
  const std::string html = map_page(page);
  EXPECT_EQ(html.find("<img"), html.npos);
  EXPECT_EQ(data_of(html).at("poses").at(0).at("state").get<std::string>().substr(0, 9),
            "</script>");
  EXPECT_EQ(data_of(html).at("columns").at("p"), "x, y, z (m)");
  EXPECT_NE(html.find(map_page_script()), html.npos);
  const nlohmann::json poses = data_of(html).at("poses");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_TRUE(poses.at(1).at("p").at(0).is_null()) << "JSON has no NaN";
}

TEST(MapPage, ManyPosesAreThinnedWithTheirPoints) {
  MapPage page;
  for (int i = 0; i < 140'000; ++i) {
    page.poses.push_back(pose_at(i, "tracking"));
  }
  page.points = {{.p = Eigen::Vector3f::Ones(), .pose = 139'999}};
  const nlohmann::json data = data_of(map_page(page));
  ASSERT_EQ(data.at("poses").size(), 46'667U);
  const std::vector<uint8_t> sweep = decoded(data.at("points").at("sweeps"));
  EXPECT_EQ(sweep.at(0) + 256 * sweep.at(1), 46'666);
}

TEST(PageCloud, StaysBelowItsBoundAndKeepsLidarAxes) {
  PageCloud cloud(1000);
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  for (uint32_t pose = 0; pose < 50; ++pose) {
    T_map_lidar.translation().x() = 2.0 * pose;
    std::vector<Point> points;
    for (int i = 0; i < 100; ++i) {
      points.push_back({0.0F, 0.1F * static_cast<float>(i), 1.0F, 5.0F});
    }
    cloud.add(points, T_map_lidar, pose);
    EXPECT_LE(cloud.points().size(), 1000U);
  }
  EXPECT_GT(cloud.points().size(), 300U);
  EXPECT_EQ(cloud.points().front().pose, 0U);
  EXPECT_EQ(cloud.points().back().pose, 49U);
  for (const SeenFrom& point : cloud.points()) {
    EXPECT_EQ(point.p.x(), 0.0F) << "the pose is not applied";
  }
}

}  // namespace
}  // namespace adit
