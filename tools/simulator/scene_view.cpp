// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_view.hpp"

#include <algorithm>
#include <cmath>

#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

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

}  // namespace

Color mixed(const Color& from, const Color& to, double share) {
  Color result;
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = static_cast<uint8_t>(from[i] + (to[i] - from[i]) * share);
  }
  return result;
}

Color shaded(const RayHit& hit, double fading) {
  const Vector3d light(0.35, 0.25, 0.9);
  const double slope = std::abs(hit.normal.dot(light.normalized()));
  const double share = 0.35 + 0.65 * slope;
  const Color color = optics_of(hit.material).color;
  Color result;
  for (std::size_t i = 0; i < 3; ++i) {
    const double lit = share * color[i];
    result[i] = static_cast<uint8_t>(lit + (kSkyColor[i] - lit) * fading);
  }
  return result;
}

Plan::Plan(const Eigen::AlignedBox3d& box, int width_px, int most_rows)
    : area(box),
      scale(box.sizes().x() / width_px),
      width(width_px),
      height(std::clamp(static_cast<int>(box.sizes().y() / scale), 50, most_rows)) {}

Eigen::Vector2i Plan::pixel(const Vector3d& at) const {
  return {static_cast<int>(std::floor((at.x() - area.min().x()) / scale)),
          height - 1 - static_cast<int>(std::floor((at.y() - area.min().y()) / scale))};
}

bool Plan::holds(const Eigen::Vector2i& pixel) const {
  return pixel.x() >= 0 && pixel.x() < width && pixel.y() >= 0 && pixel.y() < height;
}

void draw_plan(Image& image, const Plan& plan, const Scene& scene, const RayScene& still,
               double floor, const Checkpoint& checkpoint) {
  const bool has_ceiling =
      still.cast(scene.route.front() + Vector3d(0, 0, 0.5), Vector3d::UnitZ(), 30.0).has_value();
  const double top = static_cast<double>(still.bounds().max().z()) + 1.0;
  constexpr double kCut = 1.8;  // m above the floor
  constexpr Color kWall{40, 36, 34};
  in_parallel(
      static_cast<std::size_t>(plan.height), 8,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
          for (int x = 0; x < plan.width; ++x) {
            const double world_x = plan.area.min().x() + (x + 0.5) * plan.scale;
            const double world_y =
                plan.area.min().y() + (plan.height - static_cast<double>(row) - 0.5) * plan.scale;
            const double ground = std::isnan(floor) ? floor_at(scene, world_x, world_y) : floor;
            const double from = has_ceiling ? ground + kCut : top;
            const Vector3d eye(world_x, world_y, from);
            const auto hit = still.cast(eye, -Vector3d::UnitZ(), 200.0);
            const Color color = hit ? shaded(*hit, 0.0) : Color{250, 250, 250};
            image.at(x, static_cast<int>(row)) =
                has_ceiling && is_wall(still, eye, plan.scale) ? kWall : color;
          }
        }
      },
      checkpoint);
}

}  // namespace adit
