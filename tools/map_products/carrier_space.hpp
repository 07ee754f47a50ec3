// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Parts of what carries the sensor that are in its view: they stay where they are in its frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>

#include <Eigen/Core>

#include "adit/slam/mapping/map_store.hpp"

namespace adit {

/// Cells of the sensor's frame that hold the carrier.
class CarrierSpace {
 public:
  void add(uint64_t key) { cells_.insert(key); }
  /// Sensor frame, m.
  bool contains(const Eigen::Vector3d& p_lidar) const;
  bool empty() const { return cells_.empty(); }

 private:
  std::unordered_set<uint64_t> cells_;
};

/// Counts where in the sensor's frame returns lie, and how many of them lie where the map is free.
/// The carrier is in its cell from most keyframes, and where it was other submaps see through. The
/// ground and walls beside the path may be in one cell throughout as well, but nothing sees through
/// them.
class CarrierSearch {
 public:
  /// `seen_through`: other submaps saw through the return's place in the map.
  void add(const Eigen::Vector3d& p_lidar, bool seen_through, NodeId keyframe);
  /// To be called for each sweep.
  void add_keyframe(NodeId keyframe);
  CarrierSpace found() const;

 private:
  struct Cell {
    uint32_t returns = 0;
    uint32_t seen_through = 0;
    uint32_t keyframes = 0;
    NodeId last = -1;
  };

  std::unordered_map<uint64_t, Cell> cells_;
  std::unordered_set<NodeId> keyframes_;
};

}  // namespace adit
