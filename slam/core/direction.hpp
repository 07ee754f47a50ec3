// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Directions in space, such as gravity's: vectors of a fixed length on their sphere. Tangent
// vectors have two components, rad, in a basis that each direction has of its own.
#pragma once

#include <Eigen/Core>

namespace adit {

/// Two unit vectors across `direction`, which is not zero.
Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& direction);

/// `direction` turned by a tangent vector; its length stays.
Eigen::Vector3d turned(const Eigen::Vector3d& direction, const Eigen::Vector2d& delta);

/// The tangent vector at `from` that turns it to `to`: the inverse of turned(). Lengths do not
/// matter.
Eigen::Vector2d turn_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// How turn_between(from, to) changes with a tangent vector at `to`.
Eigen::Matrix2d turn_between_by_to(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace adit
