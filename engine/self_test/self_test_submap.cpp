// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test_submap.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/free_space.hpp"
#include "adit/engine/kernels/submap_merge.hpp"
#include "adit/engine/kernels/voxel_key.hpp"
#include "adit/shaders/shared/gaussian_cell.h"

namespace adit::engine {
namespace {

using Vector = std::array<double, 3>;

constexpr double kCell = 0.25;  // m
constexpr int kSide = 12;       // cells of the floor
constexpr double kHeight = -1.125;
constexpr uint32_t kSlots = 1024;
constexpr double kPlaceTolerance = 2e-5;  // m
constexpr double kSameRange = 1e-3;       // m: which of two sensors is nearer is then chance
constexpr double kNormalTolerance = 1.7e-3;

// The second sensor stands elsewhere, turned by a quarter about z.
constexpr Vector kSecond = {1.75, 0.5, 0.25};

struct Sighting {
  gpu::vec4 point;     ///< lidar frame
  double range = 0.0;  ///< m
};

Sighting seen_by_first(const Vector& p) {
  return {{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), 0.0F},
          std::hypot(p[0], p[1], p[2])};
}

Sighting seen_by_second(const Vector& p) {
  const Vector off = {p[0] - kSecond[0], p[1] - kSecond[1], p[2] - kSecond[2]};
  return {
      {static_cast<float>(off[1]), static_cast<float>(-off[0]), static_cast<float>(off[2]), 0.0F},
      std::hypot(off[0], off[1], off[2])};
}

/// A cell of the floor, with two points of each sensor in it whose mean is its centre.
struct KnownCell {
  std::array<int, 3> corner{};
  Vector centre{};
  uint32_t nearest = 0;
  bool certain = true;
};

struct KnownFloor {
  std::vector<gpu::vec4> first;
  std::vector<gpu::vec4> second;
  std::vector<KnownCell> cells;
};

KnownFloor known_floor() {
  KnownFloor floor;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      KnownCell cell{.corner = {i - 4, j - 4, -5}};
      cell.centre = {(i - 3.5) * kCell, (j - 3.5) * kCell, kHeight};
      std::array nearest = {1e9, 1e9};
      for (const double side : {-0.25, 0.25}) {
        const Sighting one =
            seen_by_first({cell.centre[0] + side * kCell, cell.centre[1] + side * kCell, kHeight});
        const Sighting other =
            seen_by_second({cell.centre[0] + side * kCell, cell.centre[1] - side * kCell, kHeight});
        floor.first.push_back(one.point);
        floor.second.push_back(other.point);
        nearest = {std::min(nearest[0], one.range), std::min(nearest[1], other.range)};
      }
      cell.nearest = nearest[1] < nearest[0] ? 1 : 0;
      cell.certain = std::abs(nearest[1] - nearest[0]) > kSameRange;
      floor.cells.push_back(cell);
    }
  }
  return floor;
}

template <class T>
Buffer uploaded(Context& context, const std::vector<T>& values) {
  Buffer buffer =
      context.make_buffer(values.size() * sizeof(T), Memory::upload, "self-test of submaps");
  std::ranges::copy(values, buffer.as<T>().begin());
  return buffer;
}

template <class T>
std::vector<T> read(const Buffer& buffer) {
  const auto values = buffer.as<T>();
  return {values.begin(), values.end()};
}

SelfTestCase check_merge(const KnownFloor& floor, const std::vector<gpu::MergeCell>& table,
                         const gpu::MergeCounters& counters) {
  double worst = 0.0;
  uint64_t wrong = 0;
  uint64_t found = 0;
  for (const gpu::MergeCell& cell : table) {
    if (cell.key == gpu::kFree) {
      continue;
    }
    ++found;
    const std::array corner = unpack_voxel(cell.key);
    const auto known = std::ranges::find(floor.cells, corner, &KnownCell::corner);
    if (known == floor.cells.end() || cell.count != 4) {
      ++wrong;
      continue;
    }
    const std::array sums = {cell.sum_x, cell.sum_y, cell.sum_z};
    for (size_t k = 0; k < 3; ++k) {
      const double place =
          (corner[k] + (static_cast<double>(sums[k]) / cell.count + 0.5) / 65536.0) * kCell;
      const double off = std::abs(place - known->centre[k]);
      worst = std::isnan(off) || off > worst ? off : worst;
    }
    const uint32_t nearest = ~cell.inverted_nearest & (kMostMergedSweeps - 1);
    wrong += known->certain && nearest != known->nearest ? 1U : 0U;
  }
  return {"submap_merge",
          found == floor.cells.size() && counters.used_slots == found && wrong == 0 &&
              counters.failures == 0 && counters.out_of_range == 0 && worst <= kPlaceTolerance,
          "expected " + std::to_string(floor.cells.size()) +
              " cells of 4 points with their nearest sensor, found " + std::to_string(found) +
              ", " + std::to_string(wrong) + " wrong, means within " + std::to_string(1e3 * worst) +
              " mm; " + std::to_string(counters.failures + counters.out_of_range) + " points lost"};
}

SelfTestCase test_merge(Context& context, const SubmapMerge& kernels) {
  const KnownFloor floor = known_floor();
  const Buffer first = uploaded(context, floor.first);
  const Buffer second = uploaded(context, floor.second);
  const Buffer table =
      context.make_buffer(SubmapMerge::table_bytes(kSlots), Memory::device, "self-test's cells");
  const Buffer counters =
      context.make_buffer(sizeof(gpu::MergeCounters), Memory::device, "self-test's counters");
  const Buffer cells_back = context.make_buffer(table.size(), Memory::readback, "cells back");
  const Buffer counters_back =
      context.make_buffer(counters.size(), Memory::readback, "counters back");
  const MergeView view{.table = table, .counters = counters, .voxel_size = kCell};
  const gpu::mat3x4 here{
      {{1.0F, 0.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F, 0.0F}}};
  const gpu::mat3x4 there{{{0.0F, -1.0F, 0.0F, static_cast<float>(kSecond[0])},
                           {1.0F, 0.0F, 0.0F, static_cast<float>(kSecond[1])},
                           {0.0F, 0.0F, 1.0F, static_cast<float>(kSecond[2])}}};
  const auto count = static_cast<uint32_t>(floor.first.size());
  Recorder recorder = context.make_recorder();
  kernels.record_clear(recorder, view);
  kernels.record_add(recorder, view,
                     {.points = first, .count = count, .sweep = 0, .T_submap_lidar = here});
  kernels.record_add(recorder, view,
                     {.points = second, .count = count, .sweep = 1, .T_submap_lidar = there});
  recorder.barrier();
  recorder.copy(table, cells_back);
  recorder.copy(counters, counters_back);
  context.submit(std::move(recorder)).wait();
  return check_merge(floor, read<gpu::MergeCell>(cells_back),
                     read<gpu::MergeCounters>(counters_back)[0]);
}

/// A level floor of four by four surface cells, a point each eighth of a metre; every second one is
/// seen from below.
std::vector<gpu::uvec4> floor_points() {
  std::vector<gpu::uvec4> points;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      points.push_back({std::bit_cast<uint32_t>(static_cast<float>(0.125 * i + 0.0625)),
                        std::bit_cast<uint32_t>(static_cast<float>(0.125 * j + 0.0625)),
                        std::bit_cast<uint32_t>(static_cast<float>(kHeight)),
                        static_cast<uint32_t>((i + j) % 2)});
    }
  }
  return points;
}

/// The z of an octahedral direction, and how far the other two are from 0.
std::pair<double, double> direction_of(uint32_t packed) {
  const double x = (static_cast<double>((packed >> 15U) & 0x7fffU) - 16383.0) / 16383.0;
  const double y = (static_cast<double>(packed & 0x7fffU) - 16383.0) / 16383.0;
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z >= 0.0) {
    return {z / std::hypot(x, y, z), std::hypot(x, y) / std::hypot(x, y, z)};
  }
  const double fx = (1.0 - std::abs(y)) * (x < 0.0 ? -1.0 : 1.0);
  const double fy = (1.0 - std::abs(x)) * (y < 0.0 ? -1.0 : 1.0);
  return {z / std::hypot(fx, fy, z), std::hypot(fx, fy) / std::hypot(fx, fy, z)};
}

std::vector<SelfTestCase> test_surfaces(Context& context, const SubmapMerge& kernels) {
  const std::vector<gpu::uvec4> points = floor_points();
  const std::vector<gpu::vec4> sensors = {{1.25F, 1.25F, 0.5F, 0.0F}, {1.25F, 1.25F, -3.0F, 0.0F}};
  const auto count = static_cast<uint32_t>(points.size());
  const Buffer input = uploaded(context, points);
  const Buffer places = uploaded(context, sensors);
  const Buffer output = context.make_buffer(input.size(), Memory::device, "self-test's surfaces");
  const Buffer scratch = context.make_buffer(SubmapMerge::surface_scratch_bytes(count),
                                             Memory::device, "self-test's surface cells");
  const Buffer output_back = context.make_buffer(output.size(), Memory::readback, "surfaces back");
  const Buffer scratch_back =
      context.make_buffer(scratch.size(), Memory::readback, "surface cells back");
  Recorder recorder = context.make_recorder();
  kernels.record_surfaces(
      recorder,
      {.c_min = 0.5,
       .c_max = 100.0,
       .r_input = kCell,
       .beam_spacing = 0.0078125,
       .surface_size = 0.625},
      {.count = count, .points = input, .sensors = places, .surface_cloud = output}, scratch);
  recorder.barrier();
  recorder.copy(output, output_back);
  recorder.copy(scratch, scratch_back);
  context.submit(std::move(recorder)).wait();

  uint64_t cells = 0;
  uint64_t summed = 0;
  for (const gpu::GaussianCell& cell : read<gpu::GaussianCell>(scratch_back)) {
    if (cell.key != gpu::kFree) {
      ++cells;
      summed += cell.count;
    }
  }
  uint64_t wrong = 0;
  double worst = 0.0;
  const std::vector<gpu::uvec4> found = read<gpu::uvec4>(output_back);
  for (size_t i = 0; i < points.size(); ++i) {
    const auto [z, off] = direction_of(found[i].w);
    const bool towards = points[i].w == 0 ? z > 0.0 : z < 0.0;
    const bool kept =
        found[i].x == points[i].x && found[i].y == points[i].y && found[i].z == points[i].z;
    wrong += (found[i].w >> 30U) == 1U && towards && kept ? 0U : 1U;
    worst = std::isnan(off) || off > worst ? off : worst;
  }
  return {{"submap_surface_cells", cells == 16 && summed == count,
           "expected " + std::to_string(count) + " points in 16 surface cells, found " +
               std::to_string(summed) + " in " + std::to_string(cells)},
          {"submap_surfaces", wrong == 0 && worst <= kNormalTolerance,
           "expected every point on a plane that looks towards its sensor, found " +
               std::to_string(wrong) + " wrong, normals within " + std::to_string(worst)}};
}

/// Rays along x through voxels 1 to 7 of a row, which ends with one that is hit at 8; the voxels 3
/// and 5 hold a plane, along which the rays pass and which they cross.
std::vector<SelfTestCase> test_free_space(Context& context) {
  constexpr int kRow = 9;
  constexpr uint32_t kUnit = 1U << gpu::kSpaceBits;
  constexpr uint32_t kAlongX = gpu::kDirectionSteps;
  constexpr uint32_t kAlongY = kAlongX << gpu::kDirectionBits;
  std::vector<gpu::SpaceVoxel> table(32);
  for (int x = 1; x < kRow; ++x) {
    const uint32_t key = pack_voxel(x, 0, 0);
    uint32_t slot = mix32(key) % 32U;
    while (table[slot].key != gpu::kFree) {
      slot = (slot + 1U) % 32U;
    }
    table[slot].key = key;
    table[slot].normal = x == 3 ? kAlongY : x == 5 ? kAlongX : 0U;
  }
  const std::vector<gpu::SpaceRay> rays(100, {.hit_x = 8,
                                              .hit_y = 0,
                                              .hit_z = 0,
                                              .from_x = kUnit / 2,
                                              .from_y = kUnit / 2,
                                              .from_z = kUnit / 2,
                                              .step_x = kUnit,
                                              .step_y = 0,
                                              .step_z = 0,
                                              .samples = 8,
                                              .direction = kAlongX});
  const Buffer input = uploaded(context, rays);
  const Buffer empty = uploaded(context, table);
  const Buffer voxels = context.make_buffer(empty.size(), Memory::device, "self-test's voxels");
  const Buffer back = context.make_buffer(empty.size(), Memory::readback, "voxels back");
  const FreeSpaceVotes kernels(context);
  Recorder recorder = context.make_recorder();
  recorder.copy(empty, voxels);
  recorder.barrier();
  for (uint32_t submap = 1; submap <= 2; ++submap) {
    kernels.record_votes(recorder, voxels,
                         {.rays = input, .count = 100, .submap = submap, .most_samples = 8});
  }
  recorder.copy(voxels, back);
  context.submit(std::move(recorder)).wait();
  uint64_t wrong_seen = 0;
  uint64_t wrong_through = 0;
  for (const gpu::SpaceVoxel& voxel : read<gpu::SpaceVoxel>(back)) {
    for (int x = 1; x < kRow; ++x) {
      const bool this_one = voxel.key == pack_voxel(x, 0, 0);
      wrong_seen += this_one && voxel.seen != (x >= 7 ? 2U : 0U) ? 1U : 0U;
      wrong_through += this_one && voxel.through != (x >= 7 || x == 3 ? 0U : 2U) ? 1U : 0U;
    }
  }
  return {{"free_space_hits", wrong_seen == 0,
           "expected two submaps that see the end of a row of voxels, found " +
               std::to_string(wrong_seen) + " voxels wrong"},
          {"free_space_rays", wrong_through == 0,
           "expected two submaps that see through all before it but one, found " +
               std::to_string(wrong_through) + " voxels wrong"}};
}

}  // namespace

std::vector<SelfTestCase> test_submap(Context& context) {
  const SubmapMerge kernels(context);
  std::vector<SelfTestCase> cases = {test_merge(context, kernels)};
  for (auto some : {test_surfaces(context, kernels), test_free_space(context)}) {
    std::ranges::move(some, std::back_inserter(cases));
  }
  return cases;
}

}  // namespace adit::engine
