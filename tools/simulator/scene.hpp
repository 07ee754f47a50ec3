// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Procedural worlds. Frame: world, metres, z up.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/tools/simulator/mesh.hpp"

namespace adit {

/// Something rigid that moves.
struct MovingObject {
  std::string label;                                        ///< "car", "pedestrian"
  Mesh mesh;                                                ///< in the object's own frame
  std::function<Eigen::Isometry3d(double)> T_world_object;  ///< at a time in s from the start
};

struct Scene {
  std::string name;
  Mesh mesh;  ///< what stands still
  std::vector<MovingObject> moving;
  /// A closed way through the scene, corners on the floor; trajectories follow it, rounded.
  std::vector<Eigen::Vector3d> route;
  double corner_radius = 1.0;  ///< m, of the rounding
  double speed = 1.2;          ///< m/s, what suits the place
  double dust = 0.0;           ///< 1/m, share of pulses that dust scatters back a metre
};

/// The names that make_scene() knows.
std::vector<std::string> scene_names();

/// Throws UsageError for an unknown name, with the nearest.
void require_scene(std::string_view name);

/// Builds a scene; the seed varies what is random in it. Throws UsageError for an unknown name,
/// with the nearest.
Scene make_scene(std::string_view name, uint64_t seed);

/// Between the sensor and the sides of what drives past it, m.
inline constexpr double kClearance = 1.0;

/// Leaves out of `scene.moving` what would come within `clearance` (m, along the ground, of the box
/// around it) of a carrier at T_world_body(t) at some time of `duration` (s): those are not in town
/// that day, rather than driven through.
Scene out_of_the_way(Scene scene, const std::function<Eigen::Isometry3d(double)>& T_world_body,
                     double duration, double clearance = kClearance,
                     const Checkpoint& checkpoint = {});

Scene make_city(uint64_t seed);
Scene make_equal_houses(uint64_t seed);
Scene make_field(uint64_t seed);
Scene make_forest(uint64_t seed);
Scene make_mine(uint64_t seed);
Scene make_office(uint64_t seed);
Scene make_repeated_wing(uint64_t seed);
Scene make_ring_tunnel(uint64_t seed);
Scene make_room(uint64_t seed);
Scene make_wings(uint64_t seed);

}  // namespace adit
