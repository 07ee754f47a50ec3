// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_heap.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/tools/simulator/ray_scene.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

/// m, of what a ray from the height `from` down meets.
double height_at(const RayScene& scene, double x, double y, double from) {
  const auto hit = scene.cast({x, y, from}, -Vector3d::UnitZ(), 100.0);
  return hit ? from - hit->distance : -1e9;
}

TEST(SceneHeap, HasTheVolumeThatItStates) {
  const Scene before = make_scene("field", 7501);
  const RayScene ground(before.mesh);
  const double z = height_at(ground, 40.0, -30.0, 90.0);
  const HeapOptions heap{.at = {40.0, -30.0, z}, .radius = 2.0, .height = 1.5};
  const RayScene with(with_heaps(before, {heap}).mesh);
  constexpr double kStep = 0.02;  // m
  double volume = 0.0;
  for (double x = 37.51; x < 42.5; x += kStep) {
    for (double y = -32.49; y < -27.5; y += kStep) {
      volume += kStep * kStep * (height_at(with, x, y, z + 4.0) - height_at(ground, x, y, z + 4.0));
    }
  }
  EXPECT_NEAR(volume, volume_of(heap), 0.01 * volume_of(heap));
  EXPECT_NEAR(volume_of(heap), 3.14159 * 4.0 * 1.5 / 3.0, 0.02);
  EXPECT_THROW(with_heaps(before, {{.at = {40.0, -30.0, z + 50.0}}}), UsageError);
}

}  // namespace
}  // namespace adit
