// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/crossings.hpp"

#include <cmath>

namespace adit {

std::vector<Crossing> find_crossings(const std::function<Eigen::Isometry3d(double)>& T_world_sensor,
                                     double duration, const RayScene& still,
                                     const Checkpoint& checkpoint) {
  constexpr double kStep = 0.02;    // s
  constexpr double kApart = 0.5;    // s
  constexpr double kAtRest = 1e-6;  // m
  constexpr double kCarried = 2.0;  // m a step, 100 m/s: it was carried, by another way
  constexpr double kEdge = 1e-6;    // m: a wall at the very end of a step belongs to it
  std::vector<Crossing> found;
  double last = -kApart;
  Eigen::Vector3d from = T_world_sensor(0.0).translation();
  for (int i = 1; kStep * i <= duration; ++i) {
    pass(checkpoint);
    const double time = kStep * i;
    const Eigen::Vector3d to = T_world_sensor(time).translation();
    const double length = std::sqrt((to - from).squaredNorm());
    if (length < kAtRest) {
      continue;
    }
    const auto hit =
        length < kCarried ? still.cast(from, (to - from) / length, length + kEdge) : std::nullopt;
    if (hit) {
      if (time - last >= kApart) {
        found.push_back({.time = time, .at = from + hit->distance / length * (to - from)});
      }
      last = time;
    }
    from = to;
  }
  return found;
}

}  // namespace adit
