// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/submap_builder.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/voxel_key.hpp"
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/slam/registration/registration.hpp"
#include "adit/slam/submaps/ground_plane.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostPending = 1U << 15U;  // points; then they go to the device
constexpr double kOffsetSteps = 65536.0;         // a cell's edge, in units of its sums
constexpr double kLeastGravity = 1.0;            // m/s^2

// So that no cell's sums overflow: a down-sampled cloud has a point a voxel of r_input, however the
// voxels lie to the cells.
std::size_t most_sweeps(double r_submap, double r_input) {
  const double edge = std::ceil(std::sqrt(3.0) * r_submap / r_input) + 1.0;
  return static_cast<std::size_t>(std::clamp(gpu::kMostCellPoints / (edge * edge * edge), 1.0,
                                             static_cast<double>(engine::kMostMergedSweeps)));
}

void insert(std::span<gpu::MergeCell> table, const gpu::MergeCell& cell) {
  const auto mask = static_cast<uint32_t>(table.size() - 1);
  uint32_t slot = engine::mix32(cell.key) & mask;
  while (table[slot].key != gpu::kFree) {
    slot = (slot + 1) & mask;
  }
  table[slot] = cell;
}

int32_t steps(double metres) {
  return static_cast<int32_t>(std::lround(metres * kSubmapSteps));
}

}  // namespace

SubmapBuilder::SubmapBuilder(engine::Context& context, const PreprocessConfig& preprocess,
                             double r_submap, uint32_t slots)
    : context_(&context),
      kernels_(context),
      settings_{.c_min = preprocess.c_min,
                .c_max = preprocess.c_max,
                .r_input = r_submap,
                .beam_spacing = 0.0,
                .surface_size = preprocess.surface_size},
      most_sweeps_(most_sweeps(r_submap, preprocess.r_input)),
      table_(context.make_buffer(engine::SubmapMerge::table_bytes(slots), engine::Memory::device,
                                 "cells of a keyframe")),
      counters_(context.make_buffer(sizeof(gpu::MergeCounters), engine::Memory::device,
                                    "counters of a keyframe")),
      counters_readback_(context.make_buffer(sizeof(gpu::MergeCounters), engine::Memory::readback,
                                             "counters of a keyframe back")) {}

engine::MergeView SubmapBuilder::view() const {
  return {.table = *table_, .counters = counters_, .voxel_size = settings_.r_input};
}

void SubmapBuilder::add(const PlacedCloud& placed) {
  if (placed.gravity_odom.norm() > kLeastGravity) {
    gravity_odom_ = placed.gravity_odom;
    gravity_sigma_ = placed.gravity_sigma;
  }
  if (sweeps_.empty()) {
    T_odom_first_ = placed.T_odom_lidar;
  }
  if (!placed.cloud.empty()) {
    pending_.push_back({.begin = points_.size(),
                        .count = placed.cloud.size(),
                        .sweep = static_cast<uint32_t>(sweeps_.size())});
    points_.insert(points_.end(), placed.cloud.begin(), placed.cloud.end());
    sights_.add(static_cast<uint32_t>(sweeps_.size()), placed.cloud);
  }
  sweeps_.push_back({.stamp = placed.stamp,
                     .T_keyframe_lidar = T_odom_first_.inverse() * placed.T_odom_lidar,
                     .merged = !placed.cloud.empty()});
  if (points_.size() >= kMostPending) {
    flush();
  }
}

// Room for so many cells more, at a load of one half at most. The cells move by way of the host:
// it happens a few times in a run.
void SubmapBuilder::make_room(uint32_t cells) {
  const uint32_t used = cleared_ ? counted_.used_slots : 0;
  const uint32_t wanted = std::bit_ceil(2 * (used + cells));
  if (wanted <= view().slots()) {
    return;
  }
  const std::vector<gpu::MergeCell> old = used > 0 ? read_cells() : std::vector<gpu::MergeCell>();
  table_.reset();
  const uint64_t bytes = engine::SubmapMerge::table_bytes(wanted);
  table_ = context_->make_buffer(bytes, engine::Memory::device, "cells of a keyframe");
  if (used == 0) {
    cleared_ = false;
    return;
  }
  const engine::Buffer staging =
      context_->make_buffer(bytes, engine::Memory::upload, "cells of a keyframe moved");
  const auto table = staging.as<gpu::MergeCell>();
  std::ranges::fill(table, gpu::MergeCell{});
  for (const gpu::MergeCell& cell : old) {
    insert(table, cell);
  }
  engine::Recorder recorder = context_->make_recorder();
  recorder.copy(staging, *table_);
  context_->submit(std::move(recorder)).wait();
}

void SubmapBuilder::flush() {
  if (pending_.empty()) {
    return;
  }
  make_room(static_cast<uint32_t>(points_.size()));
  const uint64_t bytes = points_.size() * sizeof(Point);
  if (!upload_ || upload_->size() < bytes) {
    upload_.reset();
    upload_ =
        context_->make_buffer(std::bit_ceil(bytes), engine::Memory::upload, "clouds of a keyframe");
  }
  std::ranges::copy(points_, upload_->as<Point>().begin());
  engine::Recorder recorder = context_->make_recorder();
  if (!cleared_) {
    kernels_.record_clear(recorder, view());
    cleared_ = true;
  }
  {
    const engine::Scope scope = recorder.scope("submap of keyframe");
    for (const Pending& cloud : pending_) {
      kernels_.record_add(recorder, view(),
                          {.points = upload_->slice(0, bytes),
                           .begin = static_cast<uint32_t>(cloud.begin),
                           .count = static_cast<uint32_t>(cloud.count),
                           .sweep = cloud.sweep,
                           .T_submap_lidar = to_device(sweeps_[cloud.sweep].T_keyframe_lidar)});
    }
  }
  recorder.barrier();
  recorder.copy(counters_, counters_readback_);
  context_->submit(std::move(recorder)).wait();
  counted_ = counters_readback_.as<gpu::MergeCounters>()[0];
  points_.clear();
  pending_.clear();
}

// Those that hold something.
std::vector<gpu::MergeCell> SubmapBuilder::read_cells() const {
  const engine::Buffer readback =
      context_->make_buffer(table_->size(), engine::Memory::readback, "cells of a keyframe back");
  engine::Recorder recorder = context_->make_recorder();
  recorder.copy(*table_, readback);
  context_->submit(std::move(recorder)).wait();
  std::vector<gpu::MergeCell> cells;
  for (const gpu::MergeCell& cell : readback.as<gpu::MergeCell>()) {
    if (cell.key != gpu::kFree) {
      cells.push_back(cell);
    }
  }
  return cells;
}

// Cells as points, in the order of their keys: where they lie in the table is chance.
std::vector<SubmapBuilder::Merged> SubmapBuilder::merged() {
  std::vector<Merged> points;
  if (!cleared_) {
    return points;
  }
  for (const gpu::MergeCell& cell : read_cells()) {
    const bool crowded = cell.count > gpu::kMostCellPoints;
    crowded_cells_ += crowded ? 1 : 0;
    const Eigen::Vector3d sum(cell.sum_x, cell.sum_y, cell.sum_z);
    const Eigen::Vector3d offset =
        crowded ? Eigen::Vector3d::Constant(0.5)
                : Eigen::Vector3d((sum.array() / cell.count + 0.5) / kOffsetSteps);
    const std::array corner = engine::unpack_voxel(cell.key);
    const Eigen::Vector3d p =
        (Eigen::Vector3d(corner[0], corner[1], corner[2]) + offset) * settings_.r_input;
    points.push_back(
        {.key = cell.key,
         .p = p.cast<float>(),
         .sweep = static_cast<uint16_t>(~cell.inverted_nearest & (engine::kMostMergedSweeps - 1))});
  }
  std::ranges::sort(points, {}, &Merged::key);
  return points;
}

std::vector<uint32_t> SubmapBuilder::surfaces(std::span<const Merged> points,
                                              double beam_spacing) const {
  if (points.empty()) {
    return {};
  }
  const auto make = [&](uint64_t bytes, engine::Memory memory) {
    return context_->make_buffer(bytes, memory, "surfaces of a keyframe");
  };
  const auto count = static_cast<uint32_t>(points.size());
  const uint64_t cloud_bytes = count * sizeof(gpu::uvec4);
  const uint64_t sensors_at = engine::align_slice(cloud_bytes);
  const uint64_t sensor_bytes = sweeps_.size() * sizeof(gpu::vec4);
  const engine::Buffer input = make(sensors_at + sensor_bytes, engine::Memory::upload);
  const engine::Buffer device = make(sensors_at + sensor_bytes, engine::Memory::device);
  const engine::Buffer output = make(cloud_bytes, engine::Memory::device);
  const engine::Buffer readback = make(cloud_bytes, engine::Memory::readback);
  const engine::Buffer scratch =
      make(engine::SubmapMerge::surface_scratch_bytes(count), engine::Memory::device);
  auto* cloud = reinterpret_cast<gpu::uvec4*>(input.mapped());
  for (const Merged& point : points) {
    *cloud++ = {std::bit_cast<uint32_t>(point.p.x()), std::bit_cast<uint32_t>(point.p.y()),
                std::bit_cast<uint32_t>(point.p.z()), point.sweep};
  }
  auto* sensor = reinterpret_cast<gpu::vec4*>(input.mapped() + sensors_at);
  for (const SubmapSweep& sweep : sweeps_) {
    const Eigen::Vector3f place = sweep.T_keyframe_lidar.translation().cast<float>();
    *sensor++ = {place.x(), place.y(), place.z(), 0.0F};
  }
  engine::PreprocessSettings settings = settings_;
  settings.beam_spacing = beam_spacing;
  engine::Recorder recorder = context_->make_recorder();
  recorder.copy(input, device);
  recorder.barrier();
  kernels_.record_surfaces(recorder, settings,
                           {.count = count,
                            .points = device.slice(0, cloud_bytes),
                            .sensors = device.slice(sensors_at, sensor_bytes),
                            .surface_cloud = output},
                           scratch);
  recorder.barrier();
  recorder.copy(output, readback);
  context_->submit(std::move(recorder)).wait();
  std::vector<uint32_t> packed;
  for (const gpu::uvec4& point : readback.as<gpu::uvec4>()) {
    packed.push_back(point.w);
  }
  packed.resize(count);
  return packed;
}

FrozenSubmap SubmapBuilder::freeze(double beam_spacing) {
  flush();
  const std::vector<Merged> points = merged();
  const std::vector<uint32_t> packed = surfaces(points, beam_spacing);

  FrozenSubmap frozen;
  frozen.submap.r_submap = settings_.r_input;
  std::optional<Eigen::Vector3d> up;  // lidar axes
  if (gravity_odom_.norm() > kLeastGravity) {
    frozen.submap.vertical =
        gravity_sigma_ < kRoughGravity ? Vertical::gravity : Vertical::rough_gravity;
    up = -(T_odom_first_.linear().transpose() * gravity_odom_).normalized();
  } else {
    std::vector<PlanePoint> planes;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (is_plane(packed[i])) {
        planes.push_back({points[i].p.cast<double>(), surface_direction(packed[i])});
      }
    }
    up = ground_normal(planes);
    frozen.submap.vertical = up ? Vertical::ground : Vertical::unknown;
  }
  // The shortest turn: headings stay those of the lidar.
  const Eigen::Matrix3d R_keyframe_lidar =
      Eigen::Quaterniond::FromTwoVectors(up.value_or(Eigen::Vector3d::UnitZ()),
                                         Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  frozen.T_odom_keyframe = T_odom_first_;
  frozen.T_odom_keyframe.linear() = T_odom_first_.linear() * R_keyframe_lidar.transpose();
  frozen.submap.sweeps = std::move(sweeps_);
  for (SubmapSweep& sweep : frozen.submap.sweeps) {
    sweep.T_keyframe_lidar = R_keyframe_lidar * sweep.T_keyframe_lidar;
  }
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(points.size());
  for (const Merged& point : points) {
    positions.emplace_back(R_keyframe_lidar * point.p.cast<double>());
  }
  const std::vector<bool> seen_through = sights_.see_through(positions, frozen.submap.sweeps);
  frozen.submap.points.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& p = positions[i];
    frozen.submap.points.push_back({.place = {steps(p.x()), steps(p.y()), steps(p.z())},
                                    .surface = turned_surface(R_keyframe_lidar, packed[i]),
                                    .sweep = points[i].sweep,
                                    .seen_through = seen_through[i]});
  }
  sights_.clear();
  frozen.lost_points = counted_.failures + counted_.out_of_range;
  frozen.crowded_cells = crowded_cells_;
  sweeps_.clear();
  gravity_odom_.setZero();
  gravity_sigma_ = 0.0;
  counted_ = {};
  crowded_cells_ = 0;
  cleared_ = false;
  return frozen;
}

}  // namespace adit
