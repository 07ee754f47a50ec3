// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/verify/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "adit/benchmarks/verify/transfer.hpp"

namespace adit::test {
namespace {

constexpr uint32_t kUp = static_cast<uint32_t>(gpu::kDirectionSteps)
                         << (2 * gpu::kDirectionBits);  // packed (0, 0, 1)

std::vector<gpu::SpaceRay> joined(const FreeSpaceCase& made) {
  std::vector<gpu::SpaceRay> rays;
  for (const std::vector<gpu::SpaceRay>& some : made.submaps) {
    rays.insert(rays.end(), some.begin(), some.end());
  }
  return rays;
}

}  // namespace

uint64_t FreeSpaceCase::rays() const {
  uint64_t count = 0;
  for (const std::vector<gpu::SpaceRay>& some : submaps) {
    count += some.size();
  }
  return count;
}

uint64_t FreeSpaceCase::samples() const {
  uint64_t count = 0;
  for (const std::vector<gpu::SpaceRay>& some : submaps) {
    for (const gpu::SpaceRay& ray : some) {
      count += ray.samples;
    }
  }
  return count;
}

PlacedSubmap placed_sweep(std::span<const Point> cloud, const Eigen::Isometry3d& T_map_lidar) {
  auto submap = std::make_shared<KeyframeSubmap>();
  submap->sweeps.push_back({.merged = true});
  for (const Point& point : cloud) {
    if (point.x == 0.0F && point.y == 0.0F && point.z == 0.0F) {
      continue;
    }
    SubmapPoint& stored = submap->points.emplace_back();
    const std::array coordinates = {point.x, point.y, point.z};
    for (std::size_t k = 0; k < 3; ++k) {
      stored.place[k] = static_cast<int32_t>(std::lround(coordinates[k] * kSubmapSteps));
    }
  }
  return {.T_map_keyframe = T_map_lidar, .submap = submap};
}

FreeSpaceCase free_space_case(const SpaceTile& tile, double edge,
                              std::span<const PlacedSubmap> submaps) {
  FreeSpaceCase made{
      .table = space_table(tile, edge, submaps.size(), [&](std::size_t i) { return submaps[i]; }),
      .submaps = {}};
  for (gpu::SpaceVoxel& voxel : made.table) {
    voxel.normal = voxel.key % 2 == 1 ? kUp : 0;
  }
  for (const PlacedSubmap& placed : submaps) {
    made.submaps.push_back(space_rays(tile, edge, placed));
  }
  return made;
}

FreeSpaceRun::FreeSpaceRun(engine::Context& context, const FreeSpaceCase& made)
    : context_(&context),
      kernels_(context),
      rays_(upload(context, joined(made), "rays")),
      empty_(upload(context, made.table, "voxels without votes")),
      table_(context.make_buffer(empty_.size(), engine::Memory::device, "voxels")) {
  uint32_t begin = 0;
  for (const std::vector<gpu::SpaceRay>& some : made.submaps) {
    const auto count = static_cast<uint32_t>(some.size());
    if (count > 0) {
      votes_.push_back(
          {.rays = {},
           .begin = begin,
           .count = count,
           .submap = static_cast<uint32_t>(votes_.size()) + 1,
           .most_samples = std::ranges::max(some, {}, &gpu::SpaceRay::samples).samples});
    }
    begin += count;
  }
}

Times FreeSpaceRun::run() {
  run_and_wait(*context_, [&](engine::Recorder& recorder) { recorder.copy(empty_, table_); });
  return run_and_wait(*context_, [&](engine::Recorder& recorder) {
    const engine::Scope scope = recorder.scope("votes");
    for (engine::SpaceRays& one : votes_) {
      one.rays = rays_;
      kernels_.record_votes(recorder, table_, one);
    }
  });
}

std::vector<gpu::SpaceVoxel> FreeSpaceRun::table() const {
  return download<gpu::SpaceVoxel>(*context_, table_);
}

Verdict verify_votes(const FreeSpaceCase& made, std::span<const gpu::SpaceVoxel> table) {
  std::map<reference::Cell, reference::VotedVoxel> expected;
  for (const gpu::SpaceVoxel& voxel : made.table) {
    if (voxel.key != gpu::kFree) {
      expected[reference::unpacked_cell(voxel.key)].normal =
          reference::unpack_direction(voxel.normal);
    }
  }
  reference::vote(expected, made.submaps);
  Verdict verdict;
  const auto complain = [&](const std::string& what) {
    if (verdict.problems.size() < 5) {
      verdict.problems.push_back(what);
    }
  };
  double compared = 0.0;
  for (const gpu::SpaceVoxel& voxel : table) {
    if (voxel.key == gpu::kFree) {
      continue;
    }
    compared += 1.0;
    const reference::Cell at = reference::unpacked_cell(voxel.key);
    const reference::VotedVoxel& twin = expected.at(at);
    verdict.worst["most seen through"] =
        std::max(verdict.worst["most seen through"], static_cast<double>(voxel.through));
    if (voxel.seen != twin.seen || voxel.through != twin.through) {
      complain("voxel " + std::to_string(at[0]) + " " + std::to_string(at[1]) + " " +
               std::to_string(at[2]) + ": expected seen by " + std::to_string(twin.seen) +
               " and through by " + std::to_string(twin.through) + ", found " +
               std::to_string(voxel.seen) + " and " + std::to_string(voxel.through));
    }
  }
  verdict.worst["voxels compared"] = compared;
  if (compared != static_cast<double>(expected.size())) {
    complain("expected " + std::to_string(expected.size()) + " voxels");
  }
  return verdict;
}

}  // namespace adit::test
