// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/camera_simulator.hpp"

#include <algorithm>
#include <cstddef>

#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFarthest = 1e4;  // m, more than any scene is wide

Vector3d pixel_ray(const CameraProjection& camera, const Vector2d& pixel) {
  const CameraModel& model = camera.camera();
  if (model.lens != Lens::fisheye) {
    return camera.ray(pixel).value_or(Vector3d::Zero());
  }
  const auto angle = camera.angle(pixel);
  if (!angle) {
    return Vector3d::Zero();
  }
  const Vector2d seen((pixel.x() - model.cx) / model.fx, (pixel.y() - model.cy) / model.fy);
  const double radius = seen.norm();
  const SinCos turn = repeatable_sin_cos(*angle);
  const double aside = radius > 0.0 ? turn.sin / radius : 0.0;
  return Vector3d(aside * seen.x(), aside * seen.y(), turn.cos).normalized();
}

}  // namespace

std::vector<Vector3d> pixel_rays(const CameraProjection& camera) {
  const CameraModel& model = camera.camera();
  std::vector<Vector3d> rays;
  rays.reserve(model.width * model.height);
  for (std::size_t row = 0; row < model.height; ++row) {
    for (std::size_t column = 0; column < model.width; ++column) {
      rays.push_back(
          pixel_ray(camera, Vector2d(static_cast<double>(column), static_cast<double>(row))));
    }
  }
  return rays;
}

CameraSimulator::CameraSimulator(const SceneCaster& scene, const CameraModel& camera,
                                 const CameraMount& mount, uint64_t seed)
    : scene_(&scene),
      camera_(camera),
      mount_(mount),
      seed_(seed),
      rays_(pixel_rays(CameraProjection(camera))) {}

ColorImage CameraSimulator::image(double time, const Checkpoint& checkpoint) const {
  const Eigen::Isometry3d T_world_camera = pose(time);
  const Vector3d origin = T_world_camera.translation();
  const Moment moment{
      .origin = origin, .time = time, .movers = scene_->movers_near(origin, kFarthest, time, time)};
  ColorImage image{.width = camera_.width, .height = camera_.height};
  image.rgb.resize(3 * rays_.size());
  in_parallel(
      rays_.size(), 4 * camera_.width,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          if (!rays_[i].isZero(0.0)) {
            const SurfaceColor color = seen(moment, T_world_camera.linear() * rays_[i]);
            std::ranges::copy(color, image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * i));
          }
        }
      },
      checkpoint);
  return image;
}

SurfaceColor CameraSimulator::seen(const Moment& moment, const Vector3d& direction) const {
  constexpr int kPanes = 16;  // that it looks through at most
  constexpr double kBehind = 1e-6;
  double gone = 0.0;
  for (int pane = 0; pane < kPanes; ++pane) {
    const auto hit = scene_->cast(moment.origin + gone * direction, direction, kFarthest - gone,
                                  moment.time, moment.movers);
    if (!hit) {
      break;
    }
    gone += hit->hit.distance;
    if (optics_of(hit->hit.material).transmission == 0.0F) {
      return scene_->color_of(*hit, moment.origin + gone * direction, moment.time, seed_);
    }
    gone += kBehind;
  }
  return kColorOfSky;
}

}  // namespace adit
