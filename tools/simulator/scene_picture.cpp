// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "adit/tools/drawing/image_text.hpp"
#include "adit/tools/simulator/scene_view.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr int kWidth = 1200;      // px
constexpr int kViewHeight = 500;  // px
constexpr Color kPath{213, 94, 0};
constexpr Color kInk{20, 20, 20};
constexpr Color kGround{255, 255, 255};

Eigen::AlignedBox3d bounds_of(const Scene& scene) {
  Eigen::AlignedBox3f bounds;
  for (const Eigen::Vector3f& vertex : scene.mesh.vertices) {
    bounds.extend(vertex);
  }
  return bounds.cast<double>();
}

Eigen::AlignedBox3d area_of(const Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& corner : scene.route) {
    box.extend(corner);
  }
  constexpr double kMargin = 12.0;  // m
  box.extend(box.min() - Vector3d::Constant(kMargin));
  box.extend(box.max() + Vector3d::Constant(kMargin));
  return box.intersection(bounds_of(scene));
}

void draw_path(Image& image, const Plan& plan, const SplineTrajectory& trajectory) {
  constexpr double kStep = 0.05;  // s
  for (double time = 0.0; time < trajectory.duration(); time += kStep) {
    const Eigen::Vector2i at = plan.pixel(trajectory.pose(time).translation());
    for (int dx = 0; dx < 2; ++dx) {
      for (int dy = 0; dy < 2; ++dy) {
        if (plan.holds(at + Eigen::Vector2i(dx, dy))) {
          image.at(at.x() + dx, at.y() + dy) = kPath;
        }
      }
    }
  }
}

/// What is what, and how large.
void draw_words(Image& image, const Plan& plan, const Scene& scene) {
  constexpr int kHeight = 26;  // px, of a line on its ground
  const auto line = [&](int top, const std::string& words) {
    fill(image, {0, top}, {text_width_px(words) + 16, kHeight}, kGround);
    write_text(image, {8, top + 6}, words, kInk);
  };
  line(0, scene.name + " from above, x to the right, y up");
  fill(image, {0, kHeight}, {text_width_px("path") + 60, kHeight}, kGround);
  fill(image, {8, kHeight + 10}, {34, 4}, kPath);
  write_text(image, {50, kHeight + 6}, "path", kInk);
  draw_scale_bar(image, {plan.width - 24, plan.height - 20}, plan.scale);
  line(plan.height, "from the way, ahead");
}

}  // namespace

void write_scene_picture(const std::filesystem::path& file, const Scene& scene,
                         const RayScene& still, const SplineTrajectory& trajectory,
                         const Checkpoint& checkpoint) {
  const Plan plan(area_of(scene), kWidth, 1600);
  Image image(kWidth, plan.height + kViewHeight);
  draw_plan(image, plan, scene, still, std::numeric_limits<double>::quiet_NaN(), checkpoint);
  draw_path(image, plan, trajectory);

  const Eigen::Isometry3d T_world_eye = trajectory.pose(0.35 * trajectory.duration());
  constexpr double kFar = 120.0;  // m
  in_parallel(
      kViewHeight, 8,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
          for (int x = 0; x < kWidth; ++x) {
            const double right = (x - 0.5 * kWidth) / (0.5 * kWidth);
            const double down = (static_cast<double>(row) - 0.5 * kViewHeight) / (0.5 * kWidth);
            const Vector3d direction =
                T_world_eye.linear() * Vector3d(1.0, -right, -down).normalized();
            const auto hit = still.cast(T_world_eye.translation(), direction, kFar);
            image.at(x, plan.height + static_cast<int>(row)) =
                hit ? shaded(*hit, 0.8 * std::min(1.0, hit->distance / kFar)) : kSkyColor;
          }
        }
      },
      checkpoint);
  draw_words(image, plan, scene);
  write_png(file, image);
}

}  // namespace adit
