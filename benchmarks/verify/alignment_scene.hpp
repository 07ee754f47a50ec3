// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "adit/benchmarks/reference/vgicp.hpp"
#include "adit/benchmarks/verify/cases.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/engine/context.hpp"

namespace adit::test {

/// An alignment case with both sweeps preprocessed and the target's voxel map, on the device and as
/// the twin reads it.
class AlignmentScene {
 public:
  AlignmentScene(engine::Context& context, const AlignmentCase& alignment);
  /// The same from clouds that have surfaces already.
  AlignmentScene(engine::Context& context, const std::vector<gpu::uvec4>& target,
                 std::vector<gpu::uvec4> source, const Eigen::Isometry3d& T_target_source,
                 double voxel_size, const reference::AlignmentSettings& settings);

  const std::vector<gpu::uvec4>& source() const { return source_; }
  /// Source points that fall into the same voxel, and on the same side of d_max, in float32 as in
  /// double: those farther than 2e-4 voxels from every border. The others are a few in a thousand.
  std::vector<gpu::uvec4> certain_source(const Eigen::Isometry3d& pose, double d_max) const;

  /// VGICP's, compiled once a scene.
  const engine::RegistrationKernels& kernels() const { return kernels_; }
  const VoxelMapRun& map() const { return map_; }
  /// What the device's map holds, decoded.
  const reference::VoxelMap& target() const { return target_; }

  const Eigen::Isometry3d& T_target_source() const { return T_target_source_; }
  const reference::AlignmentSettings& settings() const { return settings_; }

 private:
  std::vector<gpu::uvec4> source_;
  Eigen::Isometry3d T_target_source_;
  reference::AlignmentSettings settings_;
  engine::RegistrationKernels kernels_;
  VoxelMapRun map_;
  reference::VoxelMap target_;
};

/// A room of planes, lines and isotropic points in all directions; the source is the same room from
/// elsewhere.
AlignmentScene random_surfaces_scene(engine::Context& context);

/// Packed surfaces of a class and direction drawn at random, on given points.
std::vector<gpu::uvec4> with_random_surfaces(const std::vector<Point>& points, uint64_t seed);

/// Named perturbations [rho, phi] of a pose: none, small, up to 0.4 m and 3 degrees, and in every
/// direction.
std::vector<std::pair<std::string, Vector6d>> offsets();

}  // namespace adit::test
