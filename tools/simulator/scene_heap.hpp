// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Heaps of loose material whose volume is known, for the volumes that `adit volume` measures.
#pragma once

#include <vector>

#include "adit/tools/simulator/scene.hpp"

namespace adit {

/// A cone of 48 sides on whatever ground is there.
struct HeapOptions {
  /// m, world: its middle on the floor. The ground below it is looked for from 1 m above here.
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double radius = 2.0;  ///< m
  double height = 1.2;  ///< m, of its tip above the ground
};

/// m3, between its surface and the ground.
double volume_of(const HeapOptions& heap);

/// The scene with the heaps. Throws UsageError where there is no ground below one.
Scene with_heaps(Scene scene, const std::vector<HeapOptions>& heaps);

}  // namespace adit
