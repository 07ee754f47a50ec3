// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/image_canvas.hpp"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "adit/tools/drawing/map_picture.hpp"

namespace adit {
namespace {

constexpr Color kWhite{255, 255, 255};
constexpr Color kBlue{0, 114, 178};

/// Where pixels are not white: their box in px of the drawing.
Eigen::AlignedBox2d inked(const ImageCanvas& canvas) {
  Image image = canvas.image();
  Eigen::AlignedBox2d box;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.at(x, y) != kWhite) {
        box.extend(Eigen::Vector2d(0.5 * x + 0.25, 0.5 * y + 0.25));
      }
    }
  }
  return box;
}

TEST(ImageCanvas, HasTwicePixelsAndIsWhite) {
  const ImageCanvas canvas(30.0, 20.0);
  EXPECT_EQ(canvas.image().width, 60);
  EXPECT_EQ(canvas.image().height, 40);
  EXPECT_TRUE(inked(canvas).isEmpty());
}

TEST(ImageCanvas, ShapesLieWhereAnSvgHasThem) {
  ImageCanvas canvas(100.0, 80.0);
  canvas.line({10.0, 20.0}, {60.0, 20.0}, {.color = "#0072b2", .width = 4.0});
  Eigen::AlignedBox2d box = inked(canvas);
  EXPECT_NEAR(box.min().x(), 10.0, 2.5);
  EXPECT_NEAR(box.max().x(), 60.0, 2.5);
  EXPECT_NEAR(box.min().y(), 18.0, 0.6);
  EXPECT_NEAR(box.max().y(), 22.0, 0.6);
  Image image = canvas.image();
  EXPECT_EQ(image.at(70, 40), kBlue);

  ImageCanvas disc(100.0, 80.0);
  disc.circle({50.0, 40.0}, 10.0, "#0072b2", {.color = "#000000", .width = 2.0});
  box = inked(disc);
  EXPECT_NEAR(box.sizes().x(), 22.0, 1.0);
  EXPECT_NEAR(box.center().y(), 40.0, 0.5);
  image = disc.image();
  EXPECT_EQ(image.at(100, 80), kBlue);
  EXPECT_EQ(image.at(100, 60), (Color{0, 0, 0})) << "its edge";

  ImageCanvas frame(100.0, 80.0);
  frame.rectangle({10.0, 10.0}, {50.0, 30.0}, {.color = "#0072b2"});
  image = frame.image();
  EXPECT_EQ(image.at(70, 50), kWhite) << "is not filled";
  EXPECT_EQ(image.at(20, 50), kBlue);
}

TEST(ImageCanvas, DashesHaveGaps) {
  ImageCanvas canvas(100.0, 20.0);
  canvas.line({0.0, 10.0}, {100.0, 10.0}, {.color = "#0072b2", .width = 2.0, .dash = "4 3"});
  Image image = canvas.image();
  int ink = 0;
  for (int x = 0; x < image.width; ++x) {
    ink += image.at(x, 20) != kWhite ? 1 : 0;
  }
  EXPECT_GT(ink, image.width / 3);
  EXPECT_LT(ink, 2 * image.width / 3);
}

TEST(ImageCanvas, TextHasItsAnchorAndMayReadUpwards) {
  const auto box_of = [](const SvgFont& font) {
    ImageCanvas canvas(200.0, 200.0);
    canvas.text({100.0, 100.0}, "x (m)", font);
    return inked(canvas);
  };
  const Eigen::AlignedBox2d from = box_of({});
  EXPECT_NEAR(from.min().x(), 100.0, 2.0);
  EXPECT_NEAR(from.max().y(), 100.0, 1.0);
  EXPECT_NEAR(box_of({.anchor = SvgAnchor::end}).max().x(), 100.0, 4.0);
  EXPECT_NEAR(box_of({.anchor = SvgAnchor::middle}).center().x(), 100.0, 3.0);
  const Eigen::AlignedBox2d upwards = box_of({.upwards = true});
  EXPECT_GT(upwards.sizes().y(), 2.0 * upwards.sizes().x());
  EXPECT_NEAR(upwards.max().y(), 100.0, 2.0);
}

TEST(ImageCanvas, NothingIsDrawnBesideThePicture) {
  ImageCanvas canvas(20.0, 20.0);
  canvas.line({-50.0, -50.0}, {70.0, 60.0}, {});
  canvas.text({-5.0, 3.0}, "much too long for this", {});
  canvas.circle({0.0, 0.0}, 100.0, "#0072b2", {});
  canvas.cells(std::array{CellRuns{.color = "#0072b2", .runs = {{.count = 1000}}}}, {-3.0, -3.0},
               2.0);
  EXPECT_FALSE(inked(canvas).isEmpty());
}

TEST(ImageCanvas, AMapHasItsCellsPathAndLegend) {
  std::vector<Point> points;
  for (int i = 0; i < 100; ++i) {
    points.push_back({0.1F * static_cast<float>(i), 3.0F, 1.0F, 0.0F});
  }
  std::vector<StampedPose> path(2);
  path[1].pose.translation() = Eigen::Vector3d(9.0, 0.0, 0.0);
  const std::string png = map_picture(points, path, "Map from above", {}, PictureFormat::png);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_GT(png.size(), 2000U);
  EXPECT_EQ(png, map_picture(points, path, "Map from above", {}, PictureFormat::png));
}

}  // namespace
}  // namespace adit
