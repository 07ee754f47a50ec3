// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Corridors that are alike nowhere, for buildings whose parts are alike. Metres.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "adit/tools/simulator/mesh.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {

inline constexpr double kHalfPassage =
    2.6;  ///< from a corridor's middle to the outside of its walls

/// Adds corridors from corner to corner, along x or y at z = 0. Each has bays of their own length
/// and width, with objects in them. Both ends are open.
void add_way(Mesh& mesh, const std::vector<Eigen::Vector2d>& corners, Random& random);

/// Adds where corridors meet: a square around `corner` that is open to the sides of `open`, unit
/// vectors from its middle, and closed to the others.
void add_corner(Mesh& mesh, const Eigen::Vector2d& corner,
                const std::vector<Eigen::Vector2d>& open);

/// Adds a copy of `other`, moved by `offset`.
void add_copy(Mesh& mesh, const Mesh& other, const Eigen::Vector3d& offset);

}  // namespace adit
