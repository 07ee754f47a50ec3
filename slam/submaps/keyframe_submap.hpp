// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a keyframe has seen, as a value: sweeps merged into one cloud with surfaces. It is what the
// map stores and what alignments get, so that both are the same to the last bit.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/graph/vertical.hpp"
#include "adit/slam/registration/alignment_clouds.hpp"

namespace adit {

/// Points lie on a grid of so many steps a metre.
inline constexpr double kSubmapSteps = 2048.0;

/// A sweep of the submap.
struct SubmapSweep {
  Nanoseconds stamp{0};  ///< of the sweep
  Eigen::Isometry3d T_keyframe_lidar =
      Eigen::Isometry3d::Identity();  ///< maps lidar coordinates to the keyframe
  bool merged = false;                ///< its points are in; not while the odometry coasted
};

/// A point in the keyframe's axes.
struct SubmapPoint {
  std::array<int32_t, 3> place{};  ///< 1 / kSubmapSteps m
  uint32_t surface = 0;            ///< packed: shaders/include/surface.glsl
  uint16_t sweep = 0;              ///< whose sensor was nearest, in KeyframeSubmap::sweeps
  /// Other sweeps saw through it: it has moved, and counts for nothing in alignments.
  bool seen_through = false;

  /// m, in the keyframe's axes.
  Eigen::Vector3d position() const {
    return Eigen::Vector3d(place[0], place[1], place[2]) / kSubmapSteps;
  }
};

/// The sweeps from a keyframe to the next one, merged.
struct KeyframeSubmap {
  double r_submap = 0.0;                  ///< m, edge of the cells that points were merged in
  Vertical vertical = Vertical::unknown;  ///< whether the keyframe's z axis is known to point up
  std::vector<SubmapSweep> sweeps;        ///< each of a run's sweeps is in exactly one submap
  std::vector<SubmapPoint> points;        ///< in the keyframe's axes
};

/// The box around the points, m; of a submap without points, the origin.
struct SubmapBox {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  ///< lowest corner
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();  ///< uppermost corner
};
/// Of all its points.
SubmapBox box_of(const KeyframeSubmap& submap);

/// The submap on the device, for alignments: without the points that were seen through. Throws
/// engine::OutOfMemory.
SurfaceCloud make_surface_cloud(engine::Context& context, const KeyframeSubmap& submap);

/// The direction of a packed surface, and the surface with that direction turned by a rotation.
/// What has no direction stays as it is.
Eigen::Vector3d surface_direction(uint32_t packed);
/// The same surface in axes that are turned by `rotation`.
uint32_t turned_surface(const Eigen::Matrix3d& rotation, uint32_t packed);
/// The surface has a direction: it is a line, or a plane, whose direction is its normal.
bool has_direction(uint32_t packed);
/// The surface is a plane.
bool is_plane(uint32_t packed);

}  // namespace adit
