// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "adit/tools/plans/ground_surface.hpp"

namespace adit {

/// A line of one height.
struct ContourLine {
  double height = 0.0;                    ///< m
  std::vector<Eigen::Vector2d> places{};  ///< m; of a closed line the first is not repeated
  bool closed = false;
};

/// Lines at the multiples of `step` (m), the lowest first, by marching squares between the middles
/// of cells. They end where a cell has no height.
std::vector<ContourLine> contour_lines(const GroundHeights& ground, double step);

}  // namespace adit
