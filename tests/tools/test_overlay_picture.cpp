// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/overlay_picture.hpp"

#include <array>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "adit/tools/support/base64.hpp"

namespace adit {
namespace {

using Color = std::array<uint8_t, 3>;

/// Two walls at a right angle, 10 m long and 2 m high, on a floor.
OverlayCloud corner() {
  OverlayCloud cloud;
  for (int i = 0; i < 1000; ++i) {
    const float along = 0.01F * static_cast<float>(i);
    const float up = 0.1F * static_cast<float>(i % 20);
    for (const Eigen::Vector3f& p :
         {Eigen::Vector3f(along, 0.0F, up), Eigen::Vector3f(0.0F, along, up)}) {
      cloud.points.push_back(p);
      cloud.walls.push_back(p);
    }
    cloud.points.emplace_back(along, 0.5F * along, 0.0F);
  }
  return cloud;
}

/// How many pixels of the view from above have which colour.
std::map<Color, int> colors_above(const Image& image) {
  std::map<Color, int> colors;
  for (int y = 0; y < image.width; ++y) {
    for (int x = 0; x < image.width; ++x) {
      ++colors[image.at(x, y)];
    }
  }
  return colors;
}

Eigen::Isometry3d moved(double x, double y, double yaw) {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  pose.translation() = Eigen::Vector3d(x, y, 0.0);
  return pose;
}

TEST(OverlayPicture, WhatLiesTogetherIsDarkAndWhatDoesNotIsTwoColours) {
  const OverlayCloud cloud = corner();
  const Eigen::Isometry3d together = Eigen::Isometry3d::Identity();
  const OverlayView view = view_of(cloud, cloud, together);
  EXPECT_GT(view.reach, 4.0F);
  EXPECT_LT(view.reach, 12.0F);
  const auto one = colors_above(overlay_picture(cloud, cloud, together, view));
  EXPECT_EQ(one.size(), 2U) << "white, and dark";
  const auto two = colors_above(overlay_picture(cloud, cloud, moved(0.5, 0.5, 0.0), view));
  EXPECT_EQ(two.size(), 3U) << "white, and the colour of each";
}

TEST(OverlayPicture, TheSecondCloudIsMoved) {
  const OverlayCloud first = corner();
  const Eigen::Isometry3d pose = moved(3.0, -2.0, 0.25 * std::numbers::pi);
  OverlayCloud second = first;
  for (auto* points : {&second.points, &second.walls}) {
    for (Eigen::Vector3f& p : *points) {
      p = pose.inverse().cast<float>() * p;
    }
  }
  const auto colors = colors_above(overlay_picture(first, second, pose, {.reach = 10.0F}));
  const Color dark{30, 20, 60};
  ASSERT_TRUE(colors.contains(dark));
  const int all = first.walls.empty() ? 0 : colors.at(dark);
  for (const auto& [color, count] : colors) {
    if (color != dark && color != Color{255, 255, 255}) {
      EXPECT_LT(count, all / 5) << "but for rounding they lie on each other";
    }
  }
}

TEST(OverlayPicture, NothingIsAWhitePage) {
  const OverlayView view = view_of({}, {}, Eigen::Isometry3d::Identity());
  EXPECT_EQ(colors_above(overlay_picture({}, {}, Eigen::Isometry3d::Identity(), view)).size(), 1U);
}

TEST(Base64, IsThatOfRfc4648) {
  const auto encoded = [](std::string_view text) {
    return base64(std::as_bytes(std::span(text.data(), text.size())));
  };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace adit
