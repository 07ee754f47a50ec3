// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/tools/simulator/ray_scene.hpp"

namespace adit {

/// Where a carrier goes through something solid.
struct Crossing {
  double time = 0.0;                             ///< s from the start
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< m, world
};

/// Every surface of what stands still that the origin of T_world_sensor(t) passes through within
/// `duration` (s); those less than half a second apart count once.
std::vector<Crossing> find_crossings(const std::function<Eigen::Isometry3d(double)>& T_world_sensor,
                                     double duration, const RayScene& still,
                                     const Checkpoint& checkpoint = {});

}  // namespace adit
