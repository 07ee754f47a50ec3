// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/moved_space.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/voxel_key.hpp"

namespace adit {
namespace {

constexpr double kUnits = 1U << gpu::kSpaceBits;  // a voxel's edge
// A ray begins behind what carries the sensor, and ends before what it hit by what surfaces and
// poses may be off by: m, and a share of the range. Far away beams are far apart.
constexpr double kRayBegins = 1.5;
constexpr double kRayMargin = 0.5;
constexpr double kRayMarginShare = 0.02;
constexpr double kRayReach = 60.0;  // m
// Normals of one plane agree: the length of their mean.
constexpr double kPlaneAgreement = 0.6;
constexpr uint32_t kLeastSubmapsThrough = 2;  // submaps
constexpr std::size_t kMostRays = 1U << 17U;  // rays; then they go to the device

uint32_t packed(const Eigen::Vector3d& direction) {
  uint32_t bits = 0;
  for (int k = 0; k < 3; ++k) {
    const auto steps = static_cast<int32_t>(std::lround(direction[k] * gpu::kDirectionSteps));
    bits |= (static_cast<uint32_t>(steps) & 1023U)
            << (static_cast<uint32_t>(k) * gpu::kDirectionBits);
  }
  return bits;
}

/// From the tile's centre; far beyond the keys' range where it does not fit.
Eigen::Vector3i in_tile_of(const SpaceTile& tile, const VoxelIndex& voxel) {
  constexpr int64_t kFar = 1 << 20;
  return (voxel - tile.centre).cwiseMax(-kFar).cwiseMin(kFar).cast<int>();
}

bool is_in(const SpaceTile& tile, const Eigen::Vector3i& voxel) {
  const auto half = static_cast<int>(tile.across / 2);
  return voxel.x() >= -half && voxel.x() < half && voxel.y() >= -half && voxel.y() < half;
}

struct Samples {
  int64_t first = 0;
  int64_t end = 0;  ///< one behind the last
};

/// Those of `count` samples from `from` on, a step of `direction` (voxels) apart, that are within
/// the tile and a voxel around it.
Samples within(const SpaceTile& tile, const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
               int64_t count) {
  const double half = static_cast<double>(tile.across / 2 + 1);
  const Eigen::Vector3d most(half, half, gpu::kVoxelsUpwards - 1);
  double first = 0.0;
  auto last = static_cast<double>(count - 1);
  for (int k = 0; k < 3; ++k) {
    if (std::abs(direction[k]) < 1e-9) {
      if (std::abs(from[k]) > most[k]) {
        return {};
      }
      continue;
    }
    const double one = (-most[k] - from[k]) / direction[k];
    const double other = (most[k] - from[k]) / direction[k];
    first = std::max(first, std::min(one, other));
    last = std::min(last, std::max(one, other));
  }
  const Samples samples{static_cast<int64_t>(std::ceil(first)),
                        static_cast<int64_t>(std::floor(last)) + 1};
  return samples.first < samples.end ? samples : Samples{};
}

}  // namespace

VoxelIndex voxel_of(const Eigen::Vector3d& p, double edge) {
  return (p / edge).array().floor().cast<int64_t>();
}

constexpr uint64_t kKeyBits = 21;

uint64_t key_of(const VoxelIndex& voxel) {
  uint64_t key = 0;
  for (int k = 0; k < 3; ++k) {
    key = (key << kKeyBits) | (static_cast<uint64_t>(voxel[k]) & ((uint64_t{1} << kKeyBits) - 1));
  }
  return key;
}

void MovedSpace::add(const VoxelIndex& voxel) {
  voxels_.insert(key_of(voxel));
}

bool MovedSpace::contains(const Eigen::Vector3d& point) const {
  return !voxels_.empty() && voxels_.contains(key_of(voxel_of(point, edge_)));
}

std::vector<gpu::SpaceVoxel> space_table(const SpaceTile& tile, double edge, std::size_t submaps,
                                         const std::function<PlacedSubmap(std::size_t)>& submap) {
  struct Held {
    Eigen::Vector3d normals = Eigen::Vector3d::Zero();
    uint32_t points = 0;
  };
  std::unordered_map<uint32_t, Held> held;
  for (std::size_t i = 0; i < submaps; ++i) {
    const PlacedSubmap placed = submap(i);
    for (const SubmapPoint& point : placed.submap->points) {
      const Eigen::Vector3i voxel =
          in_tile_of(tile, voxel_of(placed.T_map_keyframe * point.position(), edge));
      const uint32_t key =
          is_in(tile, voxel) ? engine::pack_voxel(voxel.x(), voxel.y(), voxel.z()) : gpu::kFree;
      if (key == gpu::kFree) {
        continue;
      }
      Held& one = held[key];
      ++one.points;
      if (is_plane(point.surface)) {
        one.normals += placed.T_map_keyframe.linear() * surface_direction(point.surface);
      }
    }
  }
  if (held.empty()) {
    return {};
  }
  std::vector<gpu::SpaceVoxel> table(std::bit_ceil(2 * held.size()));
  const auto mask = static_cast<uint32_t>(table.size() - 1);
  for (const auto& [key, one] : held) {
    uint32_t slot = engine::mix32(key) & mask;
    while (table[slot].key != gpu::kFree) {
      slot = (slot + 1) & mask;
    }
    const Eigen::Vector3d mean = one.normals / one.points;
    table[slot].key = key;
    table[slot].normal = mean.norm() > kPlaneAgreement ? packed(mean.normalized()) : 0;
  }
  return table;
}

std::vector<gpu::SpaceRay> space_rays(const SpaceTile& tile, double edge,
                                      const PlacedSubmap& placed) {
  std::vector<Eigen::Vector3d> sensors;
  for (const SubmapSweep& sweep : placed.submap->sweeps) {
    sensors.emplace_back(placed.T_map_keyframe * sweep.T_keyframe_lidar.translation());
  }
  const SpaceTile around{.centre = tile.centre, .across = tile.across + 2};
  const Eigen::Vector3d centre = tile.centre.cast<double>();
  std::vector<gpu::SpaceRay> rays;
  for (const SubmapPoint& point : placed.submap->points) {
    if (point.sweep >= sensors.size()) {
      continue;
    }
    const Eigen::Vector3d p = placed.T_map_keyframe * point.position();
    const Eigen::Vector3d& sensor = sensors[point.sweep];
    const double range = (p - sensor).norm();
    const Eigen::Vector3d direction = (p - sensor) / std::max(range, edge);
    const double end = std::min((1.0 - kRayMarginShare) * range - kRayMargin, kRayReach);
    const Eigen::Vector3d from = (sensor + kRayBegins * direction) / edge;
    const auto count = static_cast<int64_t>(std::floor((end - kRayBegins) / edge)) + 1;
    const Samples samples =
        end < kRayBegins ? Samples{} : within(tile, from - centre, direction, count);
    const Eigen::Vector3i hit = in_tile_of(tile, voxel_of(p, edge));
    if (samples.first == samples.end && !is_in(around, hit)) {
      continue;
    }
    std::array<int32_t, 3> first{};
    std::array<int32_t, 3> step{};
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      step[axis] = static_cast<int32_t>(std::lround(direction[k] * kUnits));
      // Counted from the map's origin, so that it is the same sample in whichever tile.
      const int64_t place = std::llround(from[k] * kUnits) + samples.first * step[axis] -
                            tile.centre[k] * (int64_t{1} << gpu::kSpaceBits);
      first[axis] = samples.first == samples.end ? 0 : static_cast<int32_t>(place);
    }
    rays.push_back({.hit_x = hit.x(),
                    .hit_y = hit.y(),
                    .hit_z = hit.z(),
                    .from_x = first[0],
                    .from_y = first[1],
                    .from_z = first[2],
                    .step_x = step[0],
                    .step_y = step[1],
                    .step_z = step[2],
                    .samples = static_cast<uint32_t>(samples.end - samples.first),
                    .direction = packed(direction)});
  }
  return rays;
}

MovedSpaceSearch::MovedSpaceSearch(engine::Context& context, double edge)
    : context_(&context), kernels_(context), edge_(edge) {}

std::vector<gpu::SpaceVoxel> MovedSpaceSearch::count_votes(
    std::vector<gpu::SpaceVoxel> table, const SpaceTile& tile, std::size_t submaps,
    const std::function<PlacedSubmap(std::size_t)>& submap) const {
  const uint64_t table_bytes = table.size() * sizeof(gpu::SpaceVoxel);
  const engine::Buffer voxels =
      context_->make_buffer(table_bytes, engine::Memory::device, "voxels of a tile");
  const engine::Buffer host =
      context_->make_buffer(table_bytes, engine::Memory::upload, "voxels of a tile up");
  std::ranges::copy(table, host.as<gpu::SpaceVoxel>().begin());
  bool uploaded = false;
  std::vector<gpu::SpaceRay> pending;
  std::vector<engine::SpaceRays> votes;
  const auto flush = [&] {
    if (votes.empty()) {
      return;
    }
    const engine::Buffer rays = context_->make_buffer(
        pending.size() * sizeof(gpu::SpaceRay), engine::Memory::upload, "rays through a tile");
    std::ranges::copy(pending, rays.as<gpu::SpaceRay>().begin());
    engine::Recorder recorder = context_->make_recorder();
    if (!std::exchange(uploaded, true)) {
      recorder.copy(host, voxels);
      recorder.barrier();
    }
    for (engine::SpaceRays& one : votes) {
      one.rays = rays;
      kernels_.record_votes(recorder, voxels, one);
    }
    context_->submit(std::move(recorder)).wait();
    pending.clear();
    votes.clear();
  };
  for (std::size_t i = 0; i < submaps; ++i) {
    const std::vector<gpu::SpaceRay> rays = space_rays(tile, edge_, submap(i));
    if (rays.empty()) {
      continue;
    }
    votes.push_back({.rays = {},
                     .begin = static_cast<uint32_t>(pending.size()),
                     .count = static_cast<uint32_t>(rays.size()),
                     .submap = static_cast<uint32_t>(i) + 1,
                     .most_samples = std::ranges::max(rays, {}, &gpu::SpaceRay::samples).samples});
    pending.insert(pending.end(), rays.begin(), rays.end());
    if (pending.size() >= kMostRays) {
      flush();
    }
  }
  flush();
  if (!uploaded) {
    return table;
  }
  const engine::Buffer back =
      context_->make_buffer(table_bytes, engine::Memory::readback, "voxels of a tile back");
  engine::Recorder recorder = context_->make_recorder();
  recorder.copy(voxels, back);
  context_->submit(std::move(recorder)).wait();
  std::ranges::copy(back.as<gpu::SpaceVoxel>(), table.begin());
  return table;
}

std::vector<VoxelIndex> MovedSpaceSearch::in_tile(
    const SpaceTile& tile, std::size_t submaps,
    const std::function<PlacedSubmap(std::size_t)>& submap) const {
  std::vector<gpu::SpaceVoxel> table = space_table(tile, edge_, submaps, submap);
  std::vector<VoxelIndex> moved;
  if (table.empty()) {
    return moved;
  }
  for (const gpu::SpaceVoxel& voxel : count_votes(std::move(table), tile, submaps, submap)) {
    if (voxel.through >= kLeastSubmapsThrough && 2 * voxel.through > 3 * voxel.seen) {
      const std::array at = engine::unpack_voxel(voxel.key);
      moved.emplace_back(tile.centre + VoxelIndex(at[0], at[1], at[2]));
    }
  }
  return moved;
}

}  // namespace adit
