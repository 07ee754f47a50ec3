// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twin of submap_merge.comp.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/benchmarks/reference/downsample.hpp"
#include "adit/shaders/shared/submap.h"

namespace adit::reference {

/// A cloud in its own lidar's frame, and where that was.
struct CloudToMerge {
  std::span<const Point> points;
  Eigen::Isometry3d T_submap_lidar = Eigen::Isometry3d::Identity();
};

struct MergedCell {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< offset from the cell's corner, cells
  uint32_t count = 0;
  uint32_t nearest = 0;            ///< the cloud whose sensor was nearest to one of its points
  bool nearest_is_certain = true;  ///< no other cloud's sensor was as near, as far as stored
  bool certain = true;             ///< no point lies so near a border that float32 decides
};

struct MergedClouds {
  std::map<Cell, MergedCell> cells;
  std::set<Cell> near_a_border;  ///< cells that such points may have been taken for
  double border = 0.0;           ///< by how much of a cell float32 may be off
};

/// One mean a cell of `edge` (m). Points nearer to a border than `border` (cells) are not certain.
inline MergedClouds merge(std::span<const CloudToMerge> clouds, double edge, double border) {
  MergedClouds merged{.cells = {}, .near_a_border = {}, .border = border};
  std::map<Cell, double> nearest;  // m
  std::map<Cell, double> second;   // m, of another cloud
  for (std::size_t number = 0; number < clouds.size(); ++number) {
    for (const Point& point : clouds[number].points) {
      const Eigen::Vector3d seen(point.x, point.y, point.z);
      const Eigen::Vector3d scaled = clouds[number].T_submap_lidar * seen / edge;
      const Eigen::Vector3d corner = scaled.array().floor();
      const Cell at = {static_cast<int64_t>(corner.x()), static_cast<int64_t>(corner.y()),
                       static_cast<int64_t>(corner.z())};
      MergedCell& cell = merged.cells[at];
      cell.mean += scaled - corner;
      ++cell.count;
      for (int k = 0; k < 3; ++k) {
        const double within = scaled[k] - corner[k];
        if (within < border || within > 1.0 - border) {
          Cell other = at;
          other[static_cast<std::size_t>(k)] += within < border ? -1 : 1;
          merged.near_a_border.insert({at, other});
        }
      }
      const double range = seen.norm();
      const auto [best, first] = nearest.try_emplace(at, range);
      if (first) {
        cell.nearest = static_cast<uint32_t>(number);
      } else if (cell.nearest != number) {
        const double worse = std::max(range, best->second);
        const auto [next, only] = second.try_emplace(at, worse);
        next->second = only ? worse : std::min(next->second, worse);
        cell.nearest = range < best->second ? static_cast<uint32_t>(number) : cell.nearest;
      }
      best->second = std::min(best->second, range);
    }
  }
  for (auto& [at, cell] : merged.cells) {
    cell.mean /= cell.count;
    cell.certain = !merged.near_a_border.contains(at);
    const auto other = second.find(at);
    cell.nearest_is_certain =
        other == second.end() || other->second - nearest.at(at) > 2.0 / gpu::kRangeSteps;
  }
  return merged;
}

}  // namespace adit::reference
