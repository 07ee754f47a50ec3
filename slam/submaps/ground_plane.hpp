// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace adit {

/// A point on a plane, lidar axes.
struct PlanePoint {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// The normal of the ground, upwards: of the largest plane below the sensor (which is at the
/// origin) that leans by 25 degrees at most against the lidar's z. Nothing where there is none that
/// is wide enough and holds a fair share of the points.
std::optional<Eigen::Vector3d> ground_normal(std::span<const PlanePoint> points);

}  // namespace adit
