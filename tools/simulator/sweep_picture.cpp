// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/sweep_picture.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/tools/drawing/image_text.hpp"
#include "adit/tools/simulator/scene_view.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;
using Eigen::Vector3d;

constexpr int kWidth = 1600;    // px
constexpr int kMostRows = 900;  // px of each of the two views
constexpr Color kPaper{246, 246, 246};
constexpr Color kSensorColor{213, 94, 0};

/// A point of the sweep, in the world and as the sensor was at the sweep's middle.
struct Seen {
  Vector3d p_world;
  Vector3d p_lidar;
  double brightness = 0.0;  ///< 0 to 1, among the sweep's intensities
};

std::vector<Seen> seen_of(const RangeSweep& sweep, const RangeSimulator& lidar,
                          const Eigen::Isometry3d& T_world_lidar) {
  std::vector<float> intensities;
  for (const Return& back : sweep.returns) {
    if (back.range > 0.0) {
      intensities.push_back(back.intensity);
    }
  }
  std::ranges::sort(intensities);
  const auto rank = [&](float intensity) {
    const auto below = std::ranges::lower_bound(intensities, intensity) - intensities.begin();
    return static_cast<double>(below) / static_cast<double>(intensities.size());
  };
  const Eigen::Isometry3d T_lidar_world = T_world_lidar.inverse();
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
    if (sweep.returns[i].range > 0.0) {
      const Firing& firing = sweep.firings[i];
      const double time = 1e-9 * static_cast<double>(sweep.start + firing.time);
      const Vector3d p_world =
          lidar.pose(time) * (firing.origin + sweep.returns[i].range * firing.direction);
      seen.push_back({.p_world = p_world,
                      .p_lidar = T_lidar_world * p_world,
                      .brightness = rank(sweep.returns[i].intensity)});
    }
  }
  return seen;
}

/// From dark to light: violet, blue, green, yellow.
Color heat(double share) {
  constexpr std::array<Color, 4> kStops{
      {{72, 20, 120}, {40, 105, 190}, {40, 170, 90}, {250, 205, 30}}};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  return mixed(kStops[first], kStops[first + 1], at - static_cast<double>(first));
}

Color grey(const Color& color) {
  const double bright = 0.3 * color[0] + 0.6 * color[1] + 0.1 * color[2];
  return mixed({110, 110, 110}, kPaper, std::min(1.0, bright / 255.0));
}

/// Directions as a picture: azimuth to the left, elevation upwards, equal scales.
struct Panorama {
  Vector2d low;   ///< rad, azimuth and elevation
  Vector2d high;  ///< rad
  double scale;   ///< rad a pixel
  int height;     ///< px

  /// What the sensor's pulses reach, and a little around it.
  explicit Panorama(const std::vector<Firing>& firings)
      : low(Vector2d::Constant(1e9)), high(-low), scale(1.0), height(0) {
    for (const Firing& firing : firings) {
      const Vector2d at = angles(firing.direction);
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    constexpr double kMargin = 6.0 * kDegree;
    low -= Vector2d::Constant(kMargin);
    high += Vector2d::Constant(kMargin);
    low.x() = std::max(low.x(), -std::numbers::pi);
    high.x() = std::min(high.x(), std::numbers::pi);
    scale = std::max((high.x() - low.x()) / kWidth, (high.y() - low.y()) / kMostRows);
    const double centre = 0.5 * (low.x() + high.x());
    low.x() = centre - 0.5 * kWidth * scale;
    high.x() = centre + 0.5 * kWidth * scale;
    height = static_cast<int>((high.y() - low.y()) / scale);
  }

  static Vector2d angles(const Vector3d& p) {
    return {std::atan2(p.y(), p.x()), std::atan2(p.z(), p.head<2>().norm())};
  }

  Vector2i pixel(const Vector3d& p_lidar) const {
    const Vector2d at = angles(p_lidar);
    return {static_cast<int>(std::floor((high.x() - at.x()) / scale)),
            static_cast<int>(std::floor((high.y() - at.y()) / scale))};
  }

  Vector3d direction(int x, int y) const {
    const double azimuth = high.x() - (x + 0.5) * scale;
    const double elevation = high.y() - (y + 0.5) * scale;
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
  }
};

void draw_around(Image& image, const Panorama& view, const RayScene& still,
                 const Eigen::Isometry3d& T_world_lidar, const Checkpoint& checkpoint) {
  constexpr double kFar = 200.0;  // m
  in_parallel(
      static_cast<std::size_t>(view.height), 8,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
          for (int x = 0; x < kWidth; ++x) {
            const Vector3d direction =
                T_world_lidar.linear() * view.direction(x, static_cast<int>(row));
            const auto hit = still.cast(T_world_lidar.translation(), direction, kFar);
            image.at(x, static_cast<int>(row)) = hit ? grey(shaded(*hit, 0.0)) : kPaper;
          }
        }
      },
      checkpoint);
}

/// Ticks at multiples of thirty and of ten degrees.
void draw_degrees(Image& image, int top, const Panorama& view) {
  constexpr Color kInk{20, 20, 20};
  constexpr Color kGround{255, 255, 255};
  const auto label = [&](const Vector2i& at, int degrees) {
    const std::string words = std::to_string(degrees);
    fill(image, at - Vector2i(2, 2), {text_width_px(words) + 2, 18}, kGround);
    write_text(image, at, words, kInk);
  };
  for (int azimuth = -180; azimuth <= 180; azimuth += 30) {
    const int x = static_cast<int>(std::floor((view.high.x() - azimuth * kDegree) / view.scale));
    if (x > 20 && x < image.width - 60) {
      fill(image, {x, image.height - 10}, {2, 10}, kInk);
      label({x + 6, image.height - 18}, azimuth);
    }
  }
  for (int elevation = -90; elevation <= 90; elevation += 10) {
    const int y =
        top + static_cast<int>(std::floor((view.high.y() - elevation * kDegree) / view.scale));
    if (y > top + 40 && y < image.height - 30) {
      fill(image, {0, y}, {10, 2}, kInk);
      label({14, y - 6}, elevation);
    }
  }
}

/// Around the sensor, as far as nine tenths of its points lie.
Plan plan_around(const std::vector<Seen>& seen, const Vector3d& at) {
  std::vector<double> distances = {5.0};
  for (const Seen& point : seen) {
    distances.push_back((point.p_world - at).head<2>().norm());
  }
  const auto most = distances.begin() +
                    static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(distances.size() - 1));
  std::ranges::nth_element(distances, most);
  const Vector3d reach(1.15 * *most * kWidth / kMostRows, 1.15 * *most, 10.0);
  return {Eigen::AlignedBox3d(at - reach, at + reach), kWidth, kMostRows};
}

void dot(Image& image, const Vector2i& at, int first_row, int end_row, int size,
         const Color& color) {
  for (int y = at.y(); y < at.y() + size; ++y) {
    for (int x = at.x(); x < at.x() + size; ++x) {
      if (x >= 0 && x < image.width && y >= first_row && y < end_row) {
        image.at(x, y) = color;
      }
    }
  }
}

/// What is what, and how large; the plan is above, the panorama below.
void draw_words(Image& image, const Plan& plan, const Panorama& around, const std::string& sensor) {
  constexpr int kHeight = 26;  // px, of a line on its ground
  constexpr Color kInk{20, 20, 20};
  constexpr Color kGround{255, 255, 255};
  const auto line = [&](int top, const std::string& words) {
    fill(image, {0, top}, {text_width_px(words) + 16, kHeight}, kGround);
    write_text(image, {8, top + 6}, words, kInk);
  };
  std::string name = sensor;
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  line(0, "a sweep of " + name + " from above, x to the right, y up");
  const std::string low = "points by intensity, low ";
  const std::string high = " high     sensor ";
  constexpr int kBar = 120;  // px
  const int bar = 8 + text_width_px(low);
  fill(image, {0, kHeight}, {bar + kBar + text_width_px(high) + 30, kHeight}, kGround);
  write_text(image, {8, kHeight + 6}, low, kInk);
  for (int x = 0; x < kBar; ++x) {
    fill(image, {bar + x, kHeight + 5}, {1, 16}, heat(static_cast<double>(x) / kBar));
  }
  write_text(image, {bar + kBar, kHeight + 6}, high, kInk);
  fill(image, {bar + kBar + text_width_px(high), kHeight + 8}, {9, 9}, kSensorColor);
  draw_scale_bar(image, {plan.width - 24, plan.height - 20}, plan.scale);
  line(plan.height, "as the sensor sees it: azimuth to the left, elevation up, degrees");
  draw_degrees(image, plan.height, around);
}

}  // namespace

void write_sweep_picture(const std::filesystem::path& file, const Scene& scene,
                         const RangeSimulator& lidar, int64_t index, const Checkpoint& checkpoint) {
  const RangeSweep sweep = lidar.sweep(index, checkpoint);
  const int64_t middle = sweep.start + lidar.sensor().period / 2;
  const Eigen::Isometry3d T_world_lidar = lidar.pose(1e-9 * static_cast<double>(middle));
  const std::vector<Seen> seen = seen_of(sweep, lidar, T_world_lidar);
  const Panorama around(sweep.firings);
  const Vector3d at = T_world_lidar.translation();
  const Plan plan = plan_around(seen, at);

  // The plan first: it is drawn from the image's first row on.
  Image image(kWidth, plan.height + around.height);
  const auto below = lidar.still().cast(at, -Vector3d::UnitZ(), 10.0);
  draw_plan(image, plan, scene, lidar.still(), at.z() - (below ? below->distance : 1.5),
            checkpoint);
  for (int y = 0; y < plan.height; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image.at(x, y) = grey(image.at(x, y));
    }
  }
  for (const Seen& point : seen) {
    dot(image, plan.pixel(point.p_world), 0, plan.height, 2, heat(point.brightness));
  }
  dot(image, plan.pixel(at) - Vector2i(3, 3), 0, plan.height, 9, kSensorColor);

  Image panorama(kWidth, around.height);
  draw_around(panorama, around, lidar.still(), T_world_lidar, checkpoint);
  for (const Seen& point : seen) {
    dot(panorama, around.pixel(point.p_lidar), 0, around.height, 2, heat(point.brightness));
  }
  std::ranges::copy(panorama.pixels,
                    image.pixels.begin() + static_cast<std::ptrdiff_t>(plan.height) * kWidth);
  draw_words(image, plan, around, lidar.sensor().name);
  write_png(file, image);
}

}  // namespace adit
