// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_caster.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace adit {
namespace {

using Eigen::Vector3d;

double length_of(const Vector3d& v) {
  return std::sqrt(v.squaredNorm());
}

}  // namespace

SceneCaster::SceneCaster(const Scene& scene) : scene_(&scene), still_(scene.mesh) {
  for (const MovingObject& object : scene.moving) {
    moving_.emplace_back(object.mesh);
    double radius = 0.0;
    for (const Eigen::Vector3f& vertex : object.mesh.vertices) {
      radius = std::max(radius, length_of(vertex.cast<double>()));
    }
    moving_radius_.push_back(radius);
  }
}

std::vector<Mover> SceneCaster::movers_near(const Vector3d& position, double reach, double begin,
                                            double end) const {
  std::vector<Mover> near;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const Vector3d from = scene_->moving[i].T_world_object(begin).translation();
    const double way = length_of(scene_->moving[i].T_world_object(end).translation() - from);
    // Twice the way: it need not be straight.
    const Mover mover{.index = i, .center = from, .radius = moving_radius_[i] + 2.0 * way};
    if (length_of(from - position) < reach + mover.radius) {
      near.push_back(mover);
    }
  }
  return near;
}

std::optional<SceneHit> SceneCaster::cast(const Vector3d& origin, const Vector3d& direction,
                                          double farthest, double time,
                                          const std::vector<Mover>& movers) const {
  std::optional<SceneHit> nearest;
  if (const auto hit = still_.cast(origin, direction, farthest)) {
    nearest = SceneHit{.hit = *hit};
    farthest = hit->distance;
  }
  for (const Mover& mover : movers) {
    const Vector3d to_center = mover.center - origin;
    const double along = to_center.dot(direction);
    if (along < -mover.radius || along - mover.radius > farthest ||
        to_center.squaredNorm() - along * along > mover.radius * mover.radius) {
      continue;
    }
    const std::size_t i = mover.index;
    const Eigen::Isometry3d T_world_object = scene_->moving[i].T_world_object(time);
    const Vector3d to_object = T_world_object.translation() - origin;
    const Eigen::Matrix3d R_object_world = T_world_object.linear().transpose();
    const auto hit =
        moving_[i].cast(R_object_world * -to_object, R_object_world * direction, farthest);
    if (hit) {
      farthest = hit->distance;
      nearest = SceneHit{.hit = *hit, .object = static_cast<uint16_t>(i + 1)};
      nearest->hit.normal = T_world_object.linear() * hit->normal;
    }
  }
  return nearest;
}

SurfaceColor SceneCaster::color_of(const SceneHit& hit, const Vector3d& point, double time,
                                   uint64_t seed) const {
  constexpr uint64_t kOfObjects = 0x9e3779b97f4a7c15U;  // so that each has a pattern of its own
  if (hit.object == 0) {
    return surface_color(hit.hit.material, point, seed);
  }
  const Eigen::Isometry3d T_world_object = scene_->moving[hit.object - 1U].T_world_object(time);
  return surface_color(hit.hit.material,
                       T_world_object.linear().transpose() * (point - T_world_object.translation()),
                       seed + kOfObjects * hit.object);
}

}  // namespace adit
