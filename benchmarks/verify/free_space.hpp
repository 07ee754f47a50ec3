// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Submaps that vote on the voxels of a tile, on the device and by the twin.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "adit/benchmarks/reference/free_space.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/engine/kernels/free_space.hpp"
#include "adit/slam/submaps/moved_space.hpp"

namespace adit::test {

/// A tile's voxels without votes, and the rays of submaps through it.
struct FreeSpaceCase {
  std::vector<gpu::SpaceVoxel> table;
  std::vector<std::vector<gpu::SpaceRay>> submaps;

  uint64_t rays() const;
  uint64_t samples() const;
};

/// A sweep as the submap of a keyframe at its lidar; what is no return is left out.
PlacedSubmap placed_sweep(std::span<const Point> cloud, const Eigen::Isometry3d& T_map_lidar);

/// `edge` of a voxel, m. Every other voxel is given a plane that looks up, so that rays pass along
/// some and across others.
FreeSpaceCase free_space_case(const SpaceTile& tile, double edge,
                              std::span<const PlacedSubmap> submaps);

/// The votes on the device.
class FreeSpaceRun {
 public:
  FreeSpaceRun(engine::Context& context, const FreeSpaceCase& made);

  Times run();  ///< on a table without votes
  std::vector<gpu::SpaceVoxel> table() const;

 private:
  engine::Context* context_;
  engine::FreeSpaceVotes kernels_;
  std::vector<engine::SpaceRays> votes_;
  engine::Buffer rays_;
  engine::Buffer empty_;
  engine::Buffer table_;
};

/// Every vote as the twin's, on every voxel.
Verdict verify_votes(const FreeSpaceCase& made, std::span<const gpu::SpaceVoxel> table);

}  // namespace adit::test
