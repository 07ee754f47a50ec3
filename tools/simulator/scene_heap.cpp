// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_heap.hpp"

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/ray_scene.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr int kSides = 48;
constexpr int kRings = 12;
constexpr double kAbove = 1.0;   // m above the middle's floor: below ceilings, above bumps
constexpr double kBelow = 10.0;  // m that the ground may be lower

void add_heap(Mesh& mesh, const RayScene& ground, const HeapOptions& heap) {
  add_patch(mesh, kSides, kRings, Material::soil, [&](int u, int v) {
    const SinCos direction = repeatable_sin_cos(2.0 * kPi * (u % kSides) / kSides);
    const double share = static_cast<double>(v) / kRings;  // 0 in the middle
    const Eigen::Vector3d from =
        heap.at + Eigen::Vector3d(share * heap.radius * direction.cos,
                                  share * heap.radius * direction.sin, kAbove);
    const auto hit = ground.cast(from, -Eigen::Vector3d::UnitZ(), kAbove + kBelow);
    if (!hit) {
      throw UsageError(
          fmt::format("heap: there is no ground at {}, {} within 1 m above and 10 m "
                      "below {} m. Put it elsewhere.",
                      shortest(from.x()), shortest(from.y()), shortest(heap.at.z())));
    }
    return Eigen::Vector3d(from +
                           Eigen::Vector3d(0.0, 0.0, (1.0 - share) * heap.height - hit->distance));
  });
}

}  // namespace

double volume_of(const HeapOptions& heap) {
  const double base =
      0.5 * kSides * heap.radius * heap.radius * repeatable_sin_cos(2.0 * kPi / kSides).sin;
  return base * heap.height / 3.0;
}

Scene with_heaps(Scene scene, const std::vector<HeapOptions>& heaps) {
  if (heaps.empty()) {
    return scene;
  }
  const RayScene ground(scene.mesh);
  for (const HeapOptions& heap : heaps) {
    add_heap(scene.mesh, ground, heap);
  }
  return scene;
}

}  // namespace adit
