// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One linearisation of voxelised GICP as a good programmer writes it for a CPU: float32, compact
// records, a flat hash table, all cores. What a software device has to be measured by.
#pragma once

#include <array>
#include <barrier>
#include <cstdint>
#include <thread>
#include <vector>

#include <Eigen/Geometry>

#include "adit/benchmarks/reference/voxel_map.hpp"

namespace adit::bench {

class HostVgicp {
 public:
  /// Sums: 21 of H (upper triangle, row by row), 6 of the gradient, the cost, the matches.
  using Sums = std::array<double, 29>;

  /// Lengths in m. `threads` of 1 or more; the workers live as long as this.
  HostVgicp(const std::vector<reference::SurfacePoint>& source, const reference::VoxelMap& target,
            double d_max, unsigned threads);
  ~HostVgicp();
  HostVgicp(const HostVgicp&) = delete;
  HostVgicp& operator=(const HostVgicp&) = delete;

  unsigned threads() const { return static_cast<unsigned>(parts_.size()); }
  /// At a pose T_target_source; tangent vectors as in benchmarks/reference/vgicp.hpp.
  Sums linearize(const Eigen::Isometry3d& pose);

 private:
  struct alignas(16) SourcePoint {
    float p[3];
    float constraint[6];
  };
  struct alignas(64) Voxel {
    uint64_t key = 0;  // packed cell plus one; 0: free
    float mean[3]{};
    float constraint[6]{};
  };

  void add(size_t part);
  void work(size_t part);

  std::vector<SourcePoint> source_;
  std::vector<Voxel> table_;
  uint64_t mask_ = 0;
  float inverse_cell_ = 1.0F;
  float max_squared_ = 0.0F;
  Eigen::Isometry3f pose_ = Eigen::Isometry3f::Identity();
  bool done_ = false;
  std::vector<Sums> parts_;
  std::barrier<> begin_;
  std::barrier<> end_;
  std::vector<std::thread> workers_;
};

}  // namespace adit::bench
