// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twin of free_space_hits.comp and free_space_rays.comp.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "adit/benchmarks/reference/downsample.hpp"
#include "adit/shaders/shared/free_space.h"

namespace adit::reference {

/// What a voxel holds, and in how many submaps something is seen there or seen through.
struct VotedVoxel {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< zero: no plane
  uint32_t seen = 0;
  uint32_t through = 0;
};

/// Three whole numbers of ten bits with sign, as a vector of length 1 or so.
inline Eigen::Vector3d unpack_direction(uint32_t packed) {
  Eigen::Vector3d direction;
  for (uint32_t k = 0; k < 3; ++k) {
    const double steps = (packed >> (k * gpu::kDirectionBits)) & 1023U;
    direction[k] = (steps < 512.0 ? steps : steps - 1024.0) / gpu::kDirectionSteps;
  }
  return direction;
}

/// The votes of submaps, one after the other, on voxels that hold points. In double precision: all
/// numbers of the device are whole and small enough to be exact.
inline void vote(std::map<Cell, VotedVoxel>& voxels,
                 std::span<const std::vector<gpu::SpaceRay>> submaps) {
  constexpr double kLeastSlant =
      static_cast<double>(gpu::kLeastSlant) / gpu::kDirectionSteps / gpu::kDirectionSteps;
  const double voxel = std::ldexp(1.0, gpu::kSpaceBits);
  for (const std::vector<gpu::SpaceRay>& rays : submaps) {
    std::set<Cell> seen;
    std::set<Cell> through;
    for (const gpu::SpaceRay& ray : rays) {
      const Cell hit = {ray.hit_x, ray.hit_y, ray.hit_z};
      seen.insert(hit);
      for (std::size_t k = 0; k < 3; ++k) {
        for (const int64_t side : {-1, 1}) {
          Cell beside = hit;
          beside[k] += side;
          seen.insert(beside);
        }
      }
    }
    for (const gpu::SpaceRay& ray : rays) {
      const Eigen::Vector3d from(ray.from_x, ray.from_y, ray.from_z);
      const Eigen::Vector3d step(ray.step_x, ray.step_y, ray.step_z);
      const Eigen::Vector3d direction = unpack_direction(ray.direction);
      for (uint32_t k = 0; k < ray.samples; ++k) {
        const Eigen::Vector3d at = ((from + k * step) / voxel).array().floor();
        const Cell cell = {static_cast<int64_t>(at.x()), static_cast<int64_t>(at.y()),
                           static_cast<int64_t>(at.z())};
        const auto found = voxels.find(cell);
        if (found != voxels.end() && !seen.contains(cell) &&
            (found->second.normal.isZero() ||
             std::abs(direction.dot(found->second.normal)) > kLeastSlant)) {
          through.insert(cell);
        }
      }
    }
    for (auto& [cell, votes] : voxels) {
      votes.seen += seen.contains(cell) ? 1U : 0U;
      votes.through += through.contains(cell) ? 1U : 0U;
    }
  }
}

}  // namespace adit::reference
