// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twin of downsample_insert.comp, downsample_count.comp and downsample_emit.comp.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "adit/engine/kernels/preprocess.hpp"
#include "adit/slam/core/types.hpp"

namespace adit::reference {

/// Integer coordinates of a cell of some grid.
using Cell = std::array<int64_t, 3>;

/// The cell rule of all grids: floor(p * (1 / edge)), reciprocal and product in float32. Vulkan
/// rounds a product correctly, so this is a definition and not an approximation: every device makes
/// the same decision.
inline Cell cell_of(const Eigen::Vector3f& p, float inverse_edge) {
  Cell cell{};
  for (int k = 0; k < 3; ++k) {
    const float scaled = p[k] * inverse_edge;
    cell[static_cast<size_t>(k)] = static_cast<int64_t>(std::floor(scaled));
  }
  return cell;
}

/// The cell of a packed key (shaders/include/hash.glsl), which is not gpu::kFree.
inline Cell unpacked_cell(uint32_t key) {
  const uint32_t biased = key - 1;
  return {static_cast<int64_t>(biased >> 21U) - 1024,
          static_cast<int64_t>((biased >> 10U) & 2047U) - 1024,
          static_cast<int64_t>(biased & 1023U) - 512};
}

struct DownsampledPoint {
  Cell cell{};
  Eigen::Vector3d centroid =
      Eigen::Vector3d::Zero();  ///< m; exact mean, not rounded to 1/65536 of a cell
  float intensity = 0.0F;       ///< that of the first raw point in the cell
  uint32_t count = 0;
};

struct Downsampled {
  uint32_t valid_points = 0;
  std::vector<DownsampledPoint> points;  ///< in order of their cells' first appearance
};

/// NaN, infinite, no return, nearer than c_min or farther than c_max: not valid.
inline bool is_valid(const Point& point, const engine::PreprocessSettings& settings) {
  const Eigen::Vector3d p(point.x, point.y, point.z);
  if (!p.allFinite()) {
    return false;
  }
  return p.norm() >= settings.c_min && p.norm() <= settings.c_max;
}

/// One centroid a cell of r_input.
inline Downsampled downsample(std::span<const Point> raw,
                              const engine::PreprocessSettings& settings) {
  const float inverse_edge = 1.0F / static_cast<float>(settings.r_input);
  Downsampled result;
  std::map<Cell, size_t> index_of;
  for (const Point& point : raw) {
    if (!is_valid(point, settings)) {
      continue;
    }
    result.valid_points += 1;
    const Cell cell = cell_of({point.x, point.y, point.z}, inverse_edge);
    const auto [found, is_new] = index_of.try_emplace(cell, result.points.size());
    if (is_new) {
      result.points.push_back({.cell = cell, .intensity = point.intensity});
    }
    DownsampledPoint& sum = result.points[found->second];
    sum.centroid += Eigen::Vector3d(point.x, point.y, point.z);
    sum.count += 1;
  }
  for (DownsampledPoint& point : result.points) {
    point.centroid /= point.count;
  }
  return result;
}

}  // namespace adit::reference
