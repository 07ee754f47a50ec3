// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/carrier_space.hpp"

#include "adit/slam/submaps/moved_space.hpp"

namespace adit {
namespace {

constexpr double kCarrierCell = 0.1;   // m: five times the noise of ranges
constexpr double kCarrierReach = 5.0;  // m: vehicles are no longer, and it bounds the memory

}  // namespace

bool CarrierSpace::contains(const Eigen::Vector3d& p_lidar) const {
  return !cells_.empty() && cells_.contains(key_of(voxel_of(p_lidar, kCarrierCell)));
}

void CarrierSearch::add(const Eigen::Vector3d& p_lidar, bool seen_through, NodeId keyframe) {
  if (p_lidar.squaredNorm() > kCarrierReach * kCarrierReach) {
    return;
  }
  Cell& cell = cells_[key_of(voxel_of(p_lidar, kCarrierCell))];
  ++cell.returns;
  cell.seen_through += seen_through ? 1U : 0U;
  if (cell.last != keyframe) {
    cell.last = keyframe;
    ++cell.keyframes;
  }
}

void CarrierSearch::add_keyframe(NodeId keyframe) {
  keyframes_.insert(keyframe);
}

CarrierSpace CarrierSearch::found() const {
  CarrierSpace space;
  for (const auto& [key, cell] : cells_) {
    if (2 * cell.keyframes > keyframes_.size() && 2 * cell.seen_through > cell.returns) {
      space.add(key);
    }
  }
  return space;
}

}  // namespace adit
