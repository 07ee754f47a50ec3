// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernels/voxel_map.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/slam/core/lie.hpp"

namespace adit::engine {
class Context;
class Recorder;
}  // namespace adit::engine

namespace adit {

/// What the submap's table could not hold; zero is normal.
struct SubmapLoss {
  uint32_t points = 0;          ///< found no slot, or lay outside the keys' range
  uint32_t crowded_voxels = 0;  ///< times that a voxel's sums overflowed
};

/// The rolling submap S_t (LG-SLAM): the last l aligned clouds and their Gaussian voxel map, on the
/// device.
///
/// The voxel map lives in the submap's own frame, float32: at rebuilds the frame moves to the
/// newest pose, so coordinates stay small however long the drive. Between rebuilds a cloud enters
/// and the oldest leaves, exactly.
class Submap {
 public:
  Submap(engine::Context& context, const Config& config);

  /// Other voxels, before the first cloud: kernels and buffers are the same for all.
  void use_lengths(const Config& config);

  /// No cloud: nothing to align with.
  bool empty() const { return clouds_.empty(); }
  /// Forgets every cloud; buffers stay.
  void clear();

  /// Device memory for the next cloud of up to `capacity` points (uvec4 each).
  engine::Slice next_cloud(uint32_t capacity);
  /// A cloud from here is far enough from the newest one to join, or one of the first ten
  /// (of the first l).
  bool wants(const Eigen::Isometry3d& T_map_lidar) const;
  /// The cloud just written to next_cloud() joins at this pose when record_update() is next called.
  void push(uint32_t points, const Eigen::Isometry3d& T_map_lidar);

  /// Brings the voxel map up to date: the pushed cloud enters, the oldest beyond l leaves, or all
  /// is rebuilt.
  void record_update(engine::Recorder& recorder);
  /// Builds a second voxel map of the same clouds with voxels `factor` times as large; the next
  /// call overwrites it. For coarse-to-fine alignment. The oldest clouds are left out where a voxel
  /// might not hold all of their points.
  engine::VoxelMapView record_coarse(engine::Recorder& recorder, double factor);
  /// After the submission: what the map's counters say now. Returns what was lost since last time.
  SubmapLoss note_counters(const gpu::VoxelMapCounters& counters);
  /// After a submission that failed: the voxel map may hold anything.
  void invalidate() { rebuild_ = true; }

  /// As alignments read it: with NDT the Gaussians, else the sums.
  engine::VoxelMapView voxel_map() const {
    return finish_ ? engine::VoxelMapView{*finished_, counters_, voxel_size_} : view_;
  }
  /// Frame of the voxel map: T_map_submap.
  const Eigen::Isometry3d& pose() const { return T_map_submap_; }

 private:
  struct Cloud {
    engine::Buffer surface_cloud;
    uint32_t points = 0;
    Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
    gpu::mat3x4 T_submap_lidar{};  ///< as it was added to the voxel map
  };

  void record_rebuild(engine::Recorder& recorder);
  void use_table(uint32_t slots);
  void add_to_map(engine::Recorder& recorder, Cloud& cloud);
  void record_finish(engine::Recorder& recorder, const engine::VoxelMapView& map,
                     std::optional<engine::Buffer>& finished);

  engine::Context* context_;
  engine::VoxelMapKernels kernels_;
  std::optional<engine::FinishSettings> finish_;  ///< what the method makes of the sums
  SubmapConfig config_;
  double voxel_size_ = 0.0;
  double r_input_ = 0.0;    ///< m; a cloud has a point a voxel of this size
  uint32_t largest_table_;  ///< slots of the largest voxel map a kernel can bind
  double reach_ = 0.0;      ///< m; a sensor farther from the submap's frame is reason to rebuild

  std::deque<Cloud> clouds_;            ///< oldest first
  std::vector<engine::Buffer> spare_;   ///< memory of clouds that left
  std::optional<engine::Buffer> next_;  ///< handed out by next_cloud()
  bool pending_ = false;                ///< the last of clouds_ is not in the voxel map yet
  bool rebuild_ = true;

  std::optional<engine::Buffer> table_;  ///< memory of view_; made at the first rebuild
  std::optional<engine::Buffer> coarse_table_;
  std::optional<engine::Buffer> finished_;  ///< as long as the tables
  std::optional<engine::Buffer> coarse_finished_;
  engine::Buffer counters_;
  engine::Buffer coarse_counters_;
  engine::VoxelMapView view_;
  gpu::VoxelMapCounters noted_{};
  bool rebuilt_ = false;      ///< since the counters were last noted
  uint32_t live_voxels_ = 0;  ///< right after the last rebuild
  Eigen::Isometry3d T_map_submap_ = Eigen::Isometry3d::Identity();
};

}  // namespace adit
