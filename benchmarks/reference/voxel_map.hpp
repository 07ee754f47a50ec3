// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twin of voxel_map_add.comp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "adit/benchmarks/reference/surfaces.hpp"
#include "adit/shaders/shared/gaussian_cell.h"

namespace adit::reference {

inline Eigen::Vector3d facing_axis() {
  return {gpu::kFacingX, gpu::kFacingY, gpu::kFacingZ};
}

/// How a normal faces (map axes; zero where that is not known): 1 along facing_axis(), -1 against
/// it, 0 unclear.
inline int facing_of(const Eigen::Vector3d& normal) {
  const double facing = normal.dot(facing_axis());
  return std::abs(facing) > gpu::kUnclearFacing ? (facing > 0.0 ? 1 : -1) : 0;
}

/// A point's normal, zero where it is no plane or one seen edge-on.
inline Eigen::Vector3d facing_normal(const SurfacePoint& point) {
  return point.kind == SurfaceKind::plane ? point.direction
                                          : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

/// A voxel shows the other face of the wall that a normal (map axes) belongs to, or both faces.
inline bool is_other_face(const Eigen::Vector3d& normal, const Eigen::Vector2d& faces,
                          const Eigen::Matrix3d& form) {
  const int facing = facing_of(normal);
  const double other = facing > 0 ? faces.y() : faces.x();
  return facing != 0 && faces.sum() > 0.51 && other > 0.27 * faces.sum() &&
         normal.dot(form * normal) > 0.8;
}

/// Sums over the points of a voxel.
struct Voxel {
  int64_t count = 0;
  int64_t surfaces = 0;                                  ///< points with a surface
  int64_t along = 0;                                     ///< planes that face along facing_axis()
  int64_t against = 0;                                   ///< planes that face against it
  Eigen::Vector3d offset_sum = Eigen::Vector3d::Zero();  ///< from the voxel's corner, in voxels
  Eigen::Matrix3d constraint_sum = Eigen::Matrix3d::Zero();

  /// m, map frame.
  Eigen::Vector3d mean(const Cell& cell, double voxel_size) const {
    const Eigen::Vector3d corner(static_cast<double>(cell[0]), static_cast<double>(cell[1]),
                                 static_cast<double>(cell[2]));
    return (corner + offset_sum / static_cast<double>(count)) * voxel_size;
  }
  /// Shares of its surfaces that face along facing_axis(), and against it.
  Eigen::Vector2d faces() const {
    return Eigen::Vector2d(static_cast<double>(along), static_cast<double>(against)) /
           static_cast<double>(std::max<int64_t>(surfaces, 1));
  }
  /// Mean over its points; one without a surface counts as kBare of a point.
  Eigen::Matrix3d constraint() const {
    const double weights =
        static_cast<double>(surfaces) + double{gpu::kBare} * static_cast<double>(count - surfaces);
    return constraint_sum / weights;
  }
};

/// A point's voxel and its offset from the voxel's corner, in voxels.
struct Place {
  Cell cell{};
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();

  /// The point lies at least `margin` voxels from every border, so that the device, which moves
  /// points in float32, finds the same voxel.
  bool certain(double margin) const {
    return offset.minCoeff() > margin && offset.maxCoeff() < 1.0 - margin;
  }
};

inline Place place_of(const Eigen::Vector3d& p, double voxel_size) {
  const Eigen::Vector3d scaled = p * static_cast<double>(static_cast<float>(1.0 / voxel_size));
  Place place;
  for (int k = 0; k < 3; ++k) {
    const double corner = std::floor(scaled[k]);
    place.cell[static_cast<size_t>(k)] = static_cast<int64_t>(corner);
    place.offset[k] = scaled[k] - corner;
  }
  return place;
}

/// Voxels that a key can name: 1024 cells from the origin in x and y, 512 in z, of which the last
/// in x is no key.
inline bool in_range(const Cell& cell) {
  return cell[0] >= -1024 && cell[0] <= 1022 && cell[1] >= -1024 && cell[1] <= 1023 &&
         cell[2] >= -512 && cell[2] <= 511;
}

struct VoxelMap {
  double voxel_size = 0.0;  ///< m
  std::map<Cell, Voxel> voxels{};
  uint32_t out_of_range = 0;

  /// Adds a cloud moved by T_map_cloud.
  void add(std::span<const SurfacePoint> cloud, const Eigen::Isometry3d& T_map_cloud) {
    for (const SurfacePoint& point : cloud) {
      const Place place = place_of(T_map_cloud * point.p, voxel_size);
      if (!in_range(place.cell)) {
        out_of_range += 1;
        continue;
      }
      Voxel& voxel = voxels[place.cell];
      voxel.count += 1;
      voxel.surfaces += point.kind == SurfaceKind::isotropic ? 0 : 1;
      const int facing = facing_of(T_map_cloud.linear() * facing_normal(point));
      voxel.along += facing > 0 ? 1 : 0;
      voxel.against += facing < 0 ? 1 : 0;
      voxel.offset_sum += place.offset;
      voxel.constraint_sum +=
          T_map_cloud.linear() * point.constraint() * T_map_cloud.linear().transpose();
    }
  }
};

/// What the device's table holds, keys unpacked and fixed point made real; slots without points are
/// left out.
inline VoxelMap decode(std::span<const gpu::GaussianCell> table, double voxel_size) {
  VoxelMap map{.voxel_size = voxel_size};
  for (const gpu::GaussianCell& cell : table) {
    if (cell.key == gpu::kFree || cell.count == 0) {
      continue;
    }
    const Cell at = unpacked_cell(cell.key);
    const auto offset = [](uint32_t sum) { return static_cast<double>(sum) / 65536.0; };
    const auto entry = [&cell](uint32_t sum) {
      return static_cast<double>(sum) / 32768.0 - static_cast<double>(surfaces_of(cell));
    };
    Voxel voxel;
    voxel.count = points_of(cell);
    voxel.surfaces = surfaces_of(cell);
    voxel.along = cell.count >> gpu::kFacingShift;
    voxel.against = cell.surfaces >> gpu::kFacingShift;
    voxel.offset_sum << offset(cell.sum_x), offset(cell.sum_y), offset(cell.sum_z);
    voxel.constraint_sum << entry(cell.xx), entry(cell.xy), entry(cell.xz),  //
        entry(cell.xy), entry(cell.yy), entry(cell.yz),                      //
        entry(cell.xz), entry(cell.yz), entry(cell.zz);
    map.voxels[at] = voxel;
  }
  return map;
}

}  // namespace adit::reference
