// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernels/voxel_map.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/registration/front_end.hpp"

namespace adit {

/// How two clouds are compared (docs/theory/registration.md).
enum class RegistrationMethod {
  vgicp,           ///< voxelised GICP (Koide et al., ICRA 2021)
  ndt,             ///< points to Gaussians, Magnusson's score (2009)
  point_to_plane,  ///< points to the planes of their voxels
  ndt_to_ndt,      ///< Gaussians to Gaussians (Stoyanov et al., IJRR 2012): coarse and very fast
};
/// As the setting names it.
std::string_view to_string(RegistrationMethod method);
/// The method that a setting names.
RegistrationMethod method_of(const RegistrationConfig& config);
/// What voxels have to gather for it, and what is made of that; VGICP reads the sums themselves.
engine::VoxelContent content_for(RegistrationMethod method);
/// How voxels are finished for the method; nothing: they are not.
std::optional<engine::FinishSettings> finish_for(RegistrationMethod method);

/// A cloud on the device: down-sampled, with the surface at each point. Coordinates on the device
/// are float32 about `origin`.
struct SurfaceCloud {
  engine::Buffer points;  ///< uvec4 each: bits of x, y, z, packed surface
  uint32_t size = 0;      ///< points
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();     ///< m, in the cloud's own frame
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();  ///< sensor's position, m, cloud's frame
};

/// What clouds are aligned with: one voxel map a level, coarse to fine, of a cloud.
struct AlignmentTarget {
  /// One of the voxel maps.
  struct Level {
    double voxel_size = 0.0;  ///< m
    engine::Buffer table;     ///< as the method reads it
    uint32_t slots = 0;       ///< slots of its hash table
  };
  RegistrationMethod method = RegistrationMethod::vgicp;  ///< that the tables are for
  std::vector<Level> levels;                              ///< coarse to fine
  uint32_t voxels = 0;                                    ///< occupied ones of the finest level
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();       ///< m, in the cloud's own frame
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();    ///< sensor's position, m, cloud's frame
};

/// Makes clouds and targets for BatchAligner. Each call waits for the device.
class AlignmentClouds {
 public:
  /// The context outlives it.
  AlignmentClouds(engine::Context& context, const PreprocessConfig& config);

  /// Invalid points and those out of range (of `viewpoint`) are dropped, the others down-sampled;
  /// m, any frame. The order of the points does not matter but for the order of the result. A cloud
  /// far from its frame's origin is re-centred at its viewpoint. Throws engine::Error for more
  /// points than fit, engine::OutOfMemory.
  SurfaceCloud make_cloud(std::span<const Point> points,
                          const Eigen::Vector3d& viewpoint = Eigen::Vector3d::Zero());
  /// Voxel maps of the cloud, sizes in m, coarse to fine. Throws engine::Error where a voxel would
  /// hold more points than its sums do or the cloud reaches farther than a table's keys.
  AlignmentTarget make_target(const SurfaceCloud& cloud, RegistrationMethod method,
                              std::span<const double> voxel_sizes);

 private:
  AlignmentTarget::Level make_level(const SurfaceCloud& cloud, RegistrationMethod method,
                                    double voxel_size, uint32_t& voxels);
  gpu::VoxelMapCounters build(const engine::VoxelMapKernels& kernels, const SurfaceCloud& cloud,
                              const engine::VoxelMapView& map);

  engine::Context* context_;
  FrontEnd front_end_;
  engine::VoxelMapKernels surfaces_;
  engine::VoxelMapKernels moments_;
  engine::Buffer counters_;
  engine::Buffer counters_readback_;
};

}  // namespace adit
