// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/submap.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/slam/registration/alignment_clouds.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {
namespace {

// So many sweeps join wherever they are: one alone is too sparse to be aligned with.
constexpr size_t kFirstClouds = 10;
constexpr uint32_t kSmallestTable = 1U << 16U;
constexpr uint32_t kCoarseTable = 1U << 16U;
// A table this full is rebuilt: its slots are taken by voxels that every cloud has left.
constexpr double kFullestLoad = 0.5;
// A sensor this far from the submap's frame: its coordinates are still exact to 0.01 mm in float32.
constexpr double kLongestReach = 100.0;  // m
// Voxels that a key can name in z, the shortest axis.
constexpr double kKeyRange = gpu::kVoxelsUpwards;
// Share of it that the sensor may move from the submap's frame, even if points at c_max exceed it.
constexpr double kLeastReachShare = 0.25;

// The most points of one down-sampled cloud that a voxel can hold, however it lies to their grid.
uint32_t densest(uint32_t points, double voxel_size, double r_input) {
  const double edge = std::ceil(voxel_size / r_input) + 2.0;
  return static_cast<uint32_t>(std::min<double>(points, edge * edge * edge));
}

}  // namespace

Submap::Submap(engine::Context& context, const Config& config)
    : context_(&context),
      kernels_(context, content_for(method_of(config.registration))),
      finish_(finish_for(method_of(config.registration))),
      largest_table_(static_cast<uint32_t>(
          std::bit_floor(context.device().max_storage_buffer_bytes / sizeof(gpu::GaussianCell)))),
      counters_(context.make_buffer(sizeof(gpu::VoxelMapCounters), engine::Memory::device,
                                    "submap counters")),
      coarse_counters_(context.make_buffer(sizeof(gpu::VoxelMapCounters), engine::Memory::device,
                                           "coarse submap counters")) {
  use_lengths(config);
  use_table(kSmallestTable);
}

void Submap::use_lengths(const Config& config) {
  const Config full = with_lengths(config);
  config_ = config.submap;
  voxel_size_ = full.registration.r_align;
  view_.voxel_size = voxel_size_;
  r_input_ = full.preprocess.r_input;
  const double range = kKeyRange * voxel_size_;
  reach_ =
      std::min(kLongestReach, std::max(range - full.preprocess.c_max, kLeastReachShare * range));
}

void Submap::use_table(uint32_t slots) {
  table_.reset();
  table_ = context_->make_buffer(engine::VoxelMapKernels::table_bytes(slots),
                                 engine::Memory::device, "submap voxel map");
  view_ = {.table = *table_, .counters = counters_, .voxel_size = voxel_size_};
  finished_.reset();
  if (finish_) {
    finished_ = context_->make_buffer(engine::VoxelMapKernels::table_bytes(slots),
                                      engine::Memory::device, "submap Gaussians");
  }
}

void Submap::record_finish(engine::Recorder& recorder, const engine::VoxelMapView& map,
                           std::optional<engine::Buffer>& finished) {
  if (!finish_) {
    return;
  }
  if (!finished) {
    finished = context_->make_buffer(map.table.bytes, engine::Memory::device, "submap Gaussians");
  }
  recorder.barrier();
  kernels_.record_finish(recorder, map, *finish_, *finished);
  recorder.barrier();
}

void Submap::clear() {
  for (Cloud& cloud : clouds_) {
    spare_.push_back(std::move(cloud.surface_cloud));
  }
  clouds_.clear();
  pending_ = false;
  rebuild_ = true;
}

engine::Slice Submap::next_cloud(uint32_t capacity) {
  const uint64_t bytes = uint64_t{std::max(capacity, 1U)} * sizeof(gpu::uvec4);
  if (next_ && next_->size() < bytes) {
    next_.reset();
  }
  while (!next_ && !spare_.empty()) {
    if (spare_.back().size() >= bytes) {
      next_ = std::move(spare_.back());
    }
    spare_.pop_back();
  }
  if (!next_) {
    next_ = context_->make_buffer(bytes, engine::Memory::device, "surface cloud");
  }
  return *next_;
}

bool Submap::wants(const Eigen::Isometry3d& T_map_lidar) const {
  if (clouds_.size() < std::min(kFirstClouds, static_cast<size_t>(config_.l))) {
    return true;
  }
  const Eigen::Isometry3d moved = clouds_.back().T_map_lidar.inverse() * T_map_lidar;
  return moved.translation().norm() >= config_.delta_trans ||
         rotation_angle(moved.linear()) >= config_.delta_rot;
}

void Submap::push(uint32_t points, const Eigen::Isometry3d& T_map_lidar) {
  clouds_.push_back({std::move(*next_), points, T_map_lidar, {}});
  next_.reset();
  pending_ = true;
  if ((T_map_submap_.translation() - T_map_lidar.translation()).norm() > reach_) {
    rebuild_ = true;
  }
}

void Submap::add_to_map(engine::Recorder& recorder, Cloud& cloud) {
  cloud.T_submap_lidar = to_device(T_map_submap_.inverse() * cloud.T_map_lidar);
  kernels_.record_add(recorder, view_, cloud.surface_cloud, cloud.points, cloud.T_submap_lidar);
}

void Submap::record_update(engine::Recorder& recorder) {
  if (clouds_.empty() || !(pending_ || rebuild_)) {
    return;
  }
  const engine::Scope scope = recorder.scope("submap");
  pending_ = false;
  if (rebuild_) {
    record_rebuild(recorder);
    record_finish(recorder, view_, finished_);
    return;
  }
  if (clouds_.size() > static_cast<size_t>(config_.l)) {
    Cloud& oldest = clouds_.front();
    kernels_.record_remove(recorder, view_, oldest.surface_cloud, oldest.points,
                           oldest.T_submap_lidar);
    recorder.barrier();
    spare_.push_back(std::move(oldest.surface_cloud));
    clouds_.pop_front();
  }
  add_to_map(recorder, clouds_.back());
  record_finish(recorder, view_, finished_);
}

void Submap::record_rebuild(engine::Recorder& recorder) {
  while (clouds_.size() > static_cast<size_t>(config_.l)) {
    spare_.push_back(std::move(clouds_.front().surface_cloud));
    clouds_.pop_front();
  }
  // The last rebuild tells how many voxels l clouds have: room for four times as many lets the
  // submap roll on for a while before slots of voxels that all clouds have left fill the table.
  uint32_t wanted = std::bit_ceil(std::max(4 * live_voxels_, kSmallestTable));
  if (noted_.failures > 0) {
    wanted = std::max(wanted, 2 * view_.slots());
  }
  wanted = std::min(wanted, largest_table_);
  if (wanted > view_.slots()) {
    use_table(wanted);
  }
  rebuilt_ = true;
  T_map_submap_ = clouds_.back().T_map_lidar;
  kernels_.record_clear(recorder, view_);
  for (Cloud& cloud : clouds_) {
    add_to_map(recorder, cloud);
  }
  rebuild_ = false;
}

engine::VoxelMapView Submap::record_coarse(engine::Recorder& recorder, double factor) {
  const engine::Scope scope = recorder.scope("coarse submap");
  if (!coarse_table_) {
    coarse_table_ = context_->make_buffer(engine::VoxelMapKernels::table_bytes(kCoarseTable),
                                          engine::Memory::device, "coarse submap voxel map");
  }
  const engine::VoxelMapView view{
      .table = *coarse_table_, .counters = coarse_counters_, .voxel_size = voxel_size_ * factor};
  recorder.barrier();
  kernels_.record_clear(recorder, view);
  uint32_t room = gpu::kMostCellPoints;
  for (auto cloud = clouds_.rbegin(); cloud != clouds_.rend(); ++cloud) {
    const uint32_t points = std::min(cloud->points, gpu::kMostCellPoints);
    const uint32_t fullest = densest(points, view.voxel_size, r_input_);
    if (fullest > room) {
      break;
    }
    room -= fullest;
    kernels_.record_add(recorder, view, cloud->surface_cloud, points, cloud->T_submap_lidar);
  }
  record_finish(recorder, view, coarse_finished_);
  return finish_ ? engine::VoxelMapView{*coarse_finished_, coarse_counters_, view.voxel_size}
                 : view;
}

SubmapLoss Submap::note_counters(const gpu::VoxelMapCounters& counters) {
  const auto lost = [](const gpu::VoxelMapCounters& c) { return c.failures + c.out_of_range; };
  const auto since = [](uint32_t before, uint32_t now) {
    return before <= now ? now - before : now;  // a rebuild starts from zero
  };
  const SubmapLoss loss{.points = since(lost(noted_), lost(counters)),
                        .crowded_voxels = since(noted_.crowded, counters.crowded)};
  noted_ = counters;
  if (rebuilt_) {
    live_voxels_ = counters.used_slots;
    rebuilt_ = false;
  }
  if (counters.failures > 0 || counters.used_slots > kFullestLoad * view_.slots()) {
    rebuild_ = true;
  }
  return loss;
}

}  // namespace adit
