// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The points of a map with the surfaces that they lie on, and what of them lies in a slice.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

struct PlanPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, in the product's coordinates
  /// Of the surface, in the product's axes, towards the sensor; zero where it has none.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};
using TakePlanPoints = std::function<void(const MapKeyframe&, std::span<const PlanPoint>)>;

/// The wanted points of a keyframe that do not move.
std::vector<PlanPoint> plan_points_of(const MapKeyframe& keyframe, const KeyframeSubmap& submap,
                                      const ProductCoordinates& coordinates,
                                      const CloudSelection& selection);

/// All wanted points that do not move, keyframe by keyframe. Throws InputError where the map is
/// damaged.
void visit_plan_points(const MapDatabase& map, const ProductCoordinates& coordinates,
                       const CloudSelection& selection, const TakePlanPoints& take);

/// A plane with a thickness: x and y are within it, z is the distance from its middle.
struct CutPlane {
  Eigen::Isometry3d T_cut_product = Eigen::Isometry3d::Identity();
  double thickness = 0.2;  ///< m
};
/// z = `height`, with x and y as they are.
CutPlane level_cut(double height, double thickness);
/// Upright through two places: x from the first to the second, y up, 0 being the product's own.
CutPlane upright_cut(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double thickness);

/// A point of a cut.
struct CutPoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  /// Zero where the surface has none, or lies so flat in the cut that it is no line there.
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();
};
/// Nothing where the point is outside.
std::optional<CutPoint> cut(const CutPlane& plane, const PlanPoint& point);

}  // namespace adit
