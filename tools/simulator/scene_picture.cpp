// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/simulator/scene_picture.hpp"

#include <algorithm>
#include <cmath>

#include "tools/simulator/parallel.hpp"
#include "tools/simulator/png_writer.hpp"

namespace adit {
namespace {

using Color = std::array<uint8_t, 3>;
using Eigen::Vector3d;

constexpr int kWidth = 1200;      // px
constexpr int kViewHeight = 500;  // px
constexpr Color kSky{214, 226, 238};
constexpr Color kPath{214, 40, 40};

Color shaded(const RayHit& hit, double fading) {
  const Vector3d light(0.35, 0.25, 0.9);
  const double slope = std::abs(hit.normal.dot(light.normalized()));
  const double share = 0.35 + 0.65 * slope;
  const Color color = optics_of(hit.material).color;
  Color result;
  for (std::size_t i = 0; i < 3; ++i) {
    const double lit = share * color[i];
    result[i] = static_cast<uint8_t>(lit + (kSky[i] - lit) * fading);
  }
  return result;
}

Eigen::AlignedBox3d area_of(const Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& corner : scene.route) {
    box.extend(corner);
  }
  constexpr double kMargin = 12.0;  // m
  const Eigen::AlignedBox3f all = [&] {
    Eigen::AlignedBox3f bounds;
    for (const Eigen::Vector3f& vertex : scene.mesh.vertices) {
      bounds.extend(vertex);
    }
    return bounds;
  }();
  box.extend(box.min() - Vector3d::Constant(kMargin));
  box.extend(box.max() + Vector3d::Constant(kMargin));
  return box.intersection(all.cast<double>());
}

/// Height of the floor of the route that is nearest.
double floor_at(const Scene& scene, double x, double y) {
  const auto nearest = std::ranges::min_element(scene.route, {}, [&](const Vector3d& corner) {
    return (corner.head<2>() - Eigen::Vector2d(x, y)).squaredNorm();
  });
  return nearest->z();
}

/// Whether something stands within a pixel to one of the sides.
bool is_wall(const RayScene& still, const Vector3d& at, double scale) {
  const double reach = std::max(scale, 0.04);
  return still.cast(at, Vector3d::UnitX(), reach) || still.cast(at, -Vector3d::UnitX(), reach) ||
         still.cast(at, Vector3d::UnitY(), reach) || still.cast(at, -Vector3d::UnitY(), reach);
}

void draw_path(Image& image, int height, const Eigen::AlignedBox3d& area, double scale,
               const SplineTrajectory& trajectory) {
  constexpr double kStep = 0.05;  // s
  for (double time = 0.0; time < trajectory.duration(); time += kStep) {
    const Vector3d at = trajectory.pose(time).translation();
    const int x = static_cast<int>((at.x() - area.min().x()) / scale);
    const int y = height - 1 - static_cast<int>((at.y() - area.min().y()) / scale);
    for (int dx = 0; dx < 2; ++dx) {
      for (int dy = 0; dy < 2; ++dy) {
        if (x + dx >= 0 && x + dx < image.width && y + dy >= 0 && y + dy < height) {
          image.at(x + dx, y + dy) = kPath;
        }
      }
    }
  }
}

}  // namespace

void write_scene_picture(const std::filesystem::path& file, const Scene& scene,
                         const RayScene& still, const SplineTrajectory& trajectory) {
  const Eigen::AlignedBox3d area = area_of(scene);
  const double scale = area.sizes().x() / kWidth;  // m a pixel
  const int plan_height = std::clamp(static_cast<int>(area.sizes().y() / scale), 50, 1600);
  Image image(kWidth, plan_height + kViewHeight);
  const bool has_ceiling =
      still.cast(scene.route.front() + Vector3d(0, 0, 0.5), Vector3d::UnitZ(), 30.0).has_value();
  const double top = static_cast<double>(still.bounds().max().z()) + 1.0;
  constexpr double kCut = 1.8;  // m above the floor
  constexpr Color kWall{40, 36, 34};
  in_parallel(static_cast<std::size_t>(plan_height), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      for (int x = 0; x < kWidth; ++x) {
        const double world_x = area.min().x() + (x + 0.5) * scale;
        const double world_y =
            area.min().y() + (plan_height - static_cast<double>(row) - 0.5) * scale;
        const double from = has_ceiling ? floor_at(scene, world_x, world_y) + kCut : top;
        const Vector3d eye(world_x, world_y, from);
        const auto hit = still.cast(eye, -Vector3d::UnitZ(), 200.0);
        const Color color = hit ? shaded(*hit, 0.0) : Color{250, 250, 250};
        image.at(x, static_cast<int>(row)) =
            has_ceiling && is_wall(still, eye, scale) ? kWall : color;
      }
    }
  });
  draw_path(image, plan_height, area, scale, trajectory);

  const Eigen::Isometry3d T_world_eye = trajectory.pose(0.35 * trajectory.duration());
  constexpr double kFar = 120.0;  // m
  in_parallel(kViewHeight, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      for (int x = 0; x < kWidth; ++x) {
        const double right = (x - 0.5 * kWidth) / (0.5 * kWidth);
        const double down = (static_cast<double>(row) - 0.5 * kViewHeight) / (0.5 * kWidth);
        const Vector3d direction = T_world_eye.linear() * Vector3d(1.0, -right, -down).normalized();
        const auto hit = still.cast(T_world_eye.translation(), direction, kFar);
        image.at(x, plan_height + static_cast<int>(row)) =
            hit ? shaded(*hit, 0.8 * std::min(1.0, hit->distance / kFar)) : kSky;
      }
    }
  });
  write_png(file, image);
}

}  // namespace adit
