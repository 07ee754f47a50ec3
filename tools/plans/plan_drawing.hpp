// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Plans as drawings: for CAD programs, and to print.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adit/tools/plans/wall_lines.hpp"

namespace adit {

struct PlanSheet {
  std::string title{};        ///< "Plan at 1.2 m"
  std::string coordinates{};  ///< for people
  bool north_up = false;      ///< y is north of the grid, and an arrow says so
  WallLines lines{};
};

/// Lines on the layer WALLS, doubtful points on POINTS; metres in the product's coordinates.
std::string plan_dxf(const PlanSheet& sheet);

/// To print at a scale of 1:20, 1:50, 1:100, ... that fits a sheet of A1, with scale bar and grid.
std::string plan_svg(const PlanSheet& sheet);

}  // namespace adit
