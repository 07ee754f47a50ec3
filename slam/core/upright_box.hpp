// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

namespace adit {

/// A box with vertical sides, turned about the vertical. Metres.
struct UprightBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< along its axes; x is not shorter than y
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();  ///< unit vector of its x axis, x not negative

  /// m^3
  double volume() const { return size.prod(); }
  /// The corners of its footprint, counter-clockwise.
  std::array<Eigen::Vector2d, 4> footprint() const;
  /// The point lies in the box, enlarged by `margin` (m) on each side.
  bool contains(const Eigen::Vector3d& point, double margin = 0.0) const;
};

/// The box around points whose footprint is the smallest, to about a degree of its direction. The
/// same on any machine. Of no points, a box of size 0 at the origin.
UprightBox upright_box(std::span<const Eigen::Vector3d> points);

}  // namespace adit
