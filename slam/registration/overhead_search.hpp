// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses that two clouds may have to each other when nothing is known, from how they look from
// above (docs/theory/registration.md, section 7).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/slam/core/types.hpp"

namespace adit {

/// A cloud from above: a column wherever there are points, its height above its lowest point in
/// steps. Columns that rise tell places apart; the others tell how high the ground is.
struct OverheadView {
  struct Column {
    Eigen::Vector2f center = Eigen::Vector2f::Zero();  ///< m, in the cloud's own frame
    float lowest = 0.0F;                               ///< m, z of its lowest point
    float rise = 0.0F;                                 ///< occupied steps above the lowest
  };
  double step = 0.0;  ///< m, edge of a column and of a step of its height
  std::vector<Column> columns;
};

/// `step` in m. Points that are not finite are left out, and so are those farther than 1e5 m.
OverheadView overhead_view(std::span<const Point> points, double step);

struct OverheadSearchSettings {
  std::size_t most_poses = 12;
  double turn = 5.0;         ///< degrees between the headings that are tried
  double least_apart = 2.0;  ///< m; nearer poses with nearly the same heading are one
};

/// Poses T_a_b, most promising first: for each heading the shift that brings most of what rises in
/// b onto what rises in a (correlation by FFT), and the height that the ground then asks for. Both
/// clouds have z up to some 10 degrees. None where nothing rises.
std::vector<Eigen::Isometry3d> find_overhead_poses(const OverheadView& a, const OverheadView& b,
                                                   const OverheadSearchSettings& settings = {},
                                                   const Checkpoint& checkpoint = {});

}  // namespace adit
