// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernels/submap_merge.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/slam/submaps/free_space.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"

namespace adit {

/// A sweep with its place in the odometry's frame, for a submap.
struct PlacedCloud {
  Nanoseconds stamp{0};
  Eigen::Isometry3d T_odom_lidar = Eigen::Isometry3d::Identity();
  /// Down-sampled, lidar axes, m. A sweep without one belongs to the submap all the same.
  std::span<const Point> cloud;
  /// Gravity in the odometry's frame (m/s^2); zero: not known.
  Eigen::Vector3d gravity_odom = Eigen::Vector3d::Zero();
  double gravity_sigma = 0.0;  ///< of its direction, rad
};

/// A submap that nothing is added to any more.
struct FrozenSubmap {
  KeyframeSubmap submap;
  /// The keyframe has its origin at its first sweep's lidar.
  Eigen::Isometry3d T_odom_keyframe = Eigen::Isometry3d::Identity();
  uint32_t lost_points = 0;  ///< lay too far away or found no cell
  uint32_t crowded_cells =
      0;  ///< with more points than their sums hold: their centre stands for them
};

/// Merges the sweeps of a keyframe on the device and, when it is frozen, estimates their surfaces
/// there, once. Memory does not grow with the number of sweeps but with what they see.
class SubmapBuilder {
 public:
  /// A table of the device begins with `slots` slots, a power of two, and grows.
  SubmapBuilder(engine::Context& context, const PreprocessConfig& preprocess, double r_submap,
                uint32_t slots = 1U << 16U);

  bool empty() const { return sweeps_.empty(); }
  /// No more sweeps fit.
  bool full() const { return sweeps_.size() >= most_sweeps_; }

  /// The first sweep gives the submap its place.
  void add(const PlacedCloud& placed);
  /// What has been added, in an order that does not depend on the device; then it is empty again.
  /// `beam_spacing` (rad) is the angle between neighbouring beams.
  FrozenSubmap freeze(double beam_spacing);

 private:
  struct Pending {
    std::size_t begin = 0;
    std::size_t count = 0;
    uint32_t sweep = 0;
  };
  struct Merged {
    uint32_t key = 0;
    Eigen::Vector3f p = Eigen::Vector3f::Zero();  ///< axes of the first sweep's lidar
    uint16_t sweep = 0;
  };

  void flush();
  void make_room(uint32_t cells);
  engine::MergeView view() const;
  std::vector<gpu::MergeCell> read_cells() const;
  std::vector<Merged> merged();
  std::vector<uint32_t> surfaces(std::span<const Merged> points, double beam_spacing) const;

  engine::Context* context_;
  engine::SubmapMerge kernels_;
  engine::PreprocessSettings settings_;
  std::size_t most_sweeps_;
  std::optional<engine::Buffer> table_;
  std::optional<engine::Buffer> upload_;
  engine::Buffer counters_;
  engine::Buffer counters_readback_;
  gpu::MergeCounters counted_{};
  uint32_t crowded_cells_ = 0;
  bool cleared_ = false;  ///< the table, for the current submap

  Eigen::Isometry3d T_odom_first_ = Eigen::Isometry3d::Identity();  ///< the first sweep's lidar
  std::vector<SubmapSweep> sweeps_;  ///< with their poses in that lidar's axes
  std::vector<Point> points_;        ///< points of clouds that are not on the device yet
  std::vector<Pending> pending_;
  SweepSights sights_;
  Eigen::Vector3d gravity_odom_ = Eigen::Vector3d::Zero();  ///< the latest that is known
  double gravity_sigma_ = 0.0;                              ///< the same sweep's, rad
};

}  // namespace adit
