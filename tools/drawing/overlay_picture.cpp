// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/overlay_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace adit {
namespace {

constexpr int kSide = 420;         // px, of the square from above
constexpr int kStripHigh = 105;    // px, of the view from the side
constexpr int kGap = 4;            // px between the two
constexpr float kStrip = 0.1F;     // half of its depth, of the reach
constexpr float kMost = 25.0F;     // m
constexpr float kLeast = 2.0F;     // m
constexpr double kShown = 0.7;     // share of the points
constexpr double kFewWalls = 0.1;  // of the points
constexpr uint8_t kFirst = 1;
constexpr uint8_t kSecond = 2;
// By which of the two are there; told apart with any kind of colour vision.
constexpr std::array<Color, 4> kColors{
    {{255, 255, 255}, {86, 156, 214}, {232, 132, 60}, {30, 20, 60}}};
constexpr Color kRule{150, 150, 150};

bool has_walls(const OverlayCloud& cloud) {
  return static_cast<double>(cloud.walls.size()) >
         kFewWalls * static_cast<double>(cloud.points.size());
}

/// Marks where a cloud is, a bit a cloud.
struct Marks {
  std::array<uint8_t, static_cast<std::size_t>(kSide) * kSide> above{};
  std::array<uint8_t, static_cast<std::size_t>(kSide) * kStripHigh> beside{};
};

void mark(std::span<uint8_t> pixels, int rows, float column, float row, uint8_t bit) {
  if (column >= 0.0F && row >= 0.0F && column < static_cast<float>(kSide) &&
      row < static_cast<float>(rows)) {
    pixels[static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column)] |= bit;
  }
}

void mark(Marks& marks, const OverlayCloud& cloud, bool walls, const Eigen::Isometry3f& T,
          const OverlayView& view, uint8_t bit) {
  const float scale = 0.5F * static_cast<float>(kSide) / view.reach;  // px a metre
  const auto middle = 0.5F * static_cast<float>(kSide);
  for (const Eigen::Vector3f& point : walls ? cloud.walls : cloud.points) {
    const Eigen::Vector3f p = scale * (T * point - view.center);
    mark(marks.above, kSide, middle + p.x(), middle - p.y(), bit);
  }
  for (const Eigen::Vector3f& point : cloud.points) {
    const Eigen::Vector3f p = T * point - view.center;
    if (std::abs(p.y()) < kStrip * view.reach) {
      mark(marks.beside, kStripHigh, middle + scale * p.x(),
           0.5F * static_cast<float>(kStripHigh) - scale * p.z(), bit);
    }
  }
}

}  // namespace

OverlayView view_of(const OverlayCloud& first, const OverlayCloud& second,
                    const Eigen::Isometry3d& T_first_second) {
  OverlayView view;
  view.center = (0.5 * T_first_second.translation()).cast<float>();
  const Eigen::Isometry3f T = T_first_second.cast<float>();
  std::vector<float> distances;
  const auto add = [&](const Eigen::Vector3f& p) {
    distances.push_back((p - view.center).head<2>().norm());
  };
  std::ranges::for_each(first.points, add);
  std::ranges::for_each(second.points, [&](const Eigen::Vector3f& p) { add(T * p); });
  if (distances.empty()) {
    return view;
  }
  const auto most = distances.begin() +
                    static_cast<std::ptrdiff_t>(kShown * static_cast<double>(distances.size()));
  std::ranges::nth_element(distances, most);
  view.reach = std::clamp(*most, kLeast, kMost);
  return view;
}

Image overlay_picture(const OverlayCloud& first, const OverlayCloud& second,
                      const Eigen::Isometry3d& T_first_second, const OverlayView& view) {
  const bool walls = has_walls(first) && has_walls(second);
  Marks marks;
  mark(marks, first, walls, Eigen::Isometry3f::Identity(), view, kFirst);
  mark(marks, second, walls, T_first_second.cast<float>(), view, kSecond);
  Image image(kSide, kSide + kGap + kStripHigh);
  std::ranges::fill(image.pixels, kRule);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const auto at = static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x);
      image.at(x, y) = kColors.at(marks.above[at]);
      if (y < kStripHigh) {
        image.at(x, kSide + kGap + y) = kColors.at(marks.beside[at]);
      }
    }
  }
  return image;
}

}  // namespace adit
