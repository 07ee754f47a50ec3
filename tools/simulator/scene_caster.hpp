// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/simulator/ray_scene.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/surface_color.hpp"

namespace adit {

/// What a ray hits first; the normal is in the world's axes.
struct SceneHit {
  RayHit hit;
  uint16_t object = 0;  ///< 0: what stands still; n: moving object n - 1 of the scene
};

/// A moving object and a sphere that holds it for some time.
struct Mover {
  std::size_t index = 0;
  Eigen::Vector3d center;
  double radius = 0.0;  ///< m
};

/// Casts rays at a scene as it is at a time: at what stands still and at what moves.
class SceneCaster {
 public:
  /// The scene must outlive it.
  explicit SceneCaster(const Scene& scene);

  const Scene& scene() const { return *scene_; }
  const RayScene& still() const { return still_; }

  /// Moving objects within `reach` (m) of a position, from one time (s) to another.
  std::vector<Mover> movers_near(const Eigen::Vector3d& position, double reach, double begin,
                                 double end) const;

  /// The first surface on a ray within `farthest` (m) at a time (s). `direction` has unit length.
  std::optional<SceneHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                               double farthest, double time,
                               const std::vector<Mover>& movers) const;

  /// The colour at a point (world) of what was hit. The pattern of a moving object moves with it.
  SurfaceColor color_of(const SceneHit& hit, const Eigen::Vector3d& point, double time,
                        uint64_t seed) const;

 private:
  const Scene* scene_;
  RayScene still_;
  std::vector<RayScene> moving_;
  std::vector<double> moving_radius_;  ///< m, around each object's origin
};

}  // namespace adit
