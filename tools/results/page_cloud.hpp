// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/results/map_thinning.hpp"

namespace adit {

/// A point with the pose that saw it, in that lidar's axes, m.
struct SeenFrom {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
  float intensity = 0.0F;
  uint32_t pose = 0;
};

/// A cloud of bounded size from keyframes of any number: the first point of each voxel, and wider
/// voxels once there would be too many. Points keep their lidar's axes, so that they follow poses
/// that a map corrects later.
class PageCloud {
 public:
  explicit PageCloud(std::size_t most = 250'000) : most_(most), thinning_(kFinest) {}

  /// Points in lidar axes; `pose` counts the trajectory's poses.
  void add(std::span<const Point> points, const Eigen::Isometry3d& T_map_lidar, uint32_t pose);

  const std::vector<SeenFrom>& points() const { return points_; }

 private:
  static constexpr double kFinest = 0.05;  ///< m
  static constexpr double kWider = 1.5;

  void widen();

  std::size_t most_;
  double voxel_ = kFinest;
  MapThinning thinning_;
  std::vector<SeenFrom> points_;
  std::vector<Eigen::Vector3f> places_;  ///< where the points were in the map when they came
};

}  // namespace adit
