// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/plan_points.hpp"

#include <cmath>
#include <vector>

#include "adit/tools/map_database/map_trajectory.hpp"

namespace adit {
namespace {

// Surfaces that are tilted against the cut's normal by less than 30 degrees from upright: a slice
// of 0.2 m smears them by 0.1 m at most, and as many degrees are beyond any wall.
constexpr double kUpright = 0.866;
// Sine of 5 degrees, by which normals of planes are wrong now and then: of a surface that is seen
// at less it is not known which of its sides that was.
constexpr double kSideIsKnown = 0.087;

}  // namespace

std::vector<PlanPoint> plan_points_of(const MapKeyframe& keyframe, const KeyframeSubmap& submap,
                                      const ProductCoordinates& coordinates,
                                      const CloudSelection& selection) {
  const Eigen::Matrix3d R_product_keyframe = coordinates.from_map(keyframe.T_map_keyframe).linear();
  std::vector<Eigen::Vector3d> sensors;
  for (const SubmapSweep& sweep : submap.sweeps) {
    sensors.emplace_back(sweep.T_keyframe_lidar.translation());
  }
  std::vector<PlanPoint> points;
  for (const SubmapPoint& measured : submap.points) {
    const bool placed = measured.sweep < sensors.size();
    const Eigen::Vector3d p_map = keyframe.T_map_keyframe * measured.position();
    if (measured.seen_through || has_moved(selection, p_map) ||
        (selection.is_gone && selection.is_gone(p_map, keyframe.session))) {
      continue;
    }
    const CloudPoint wanted{.position = coordinates.from_map(p_map),
                            .time = placed ? submap.sweeps[measured.sweep].stamp : keyframe.stamp,
                            .keyframe = keyframe.id,
                            .session = keyframe.session};
    if (!is_wanted(selection, wanted)) {
      continue;
    }
    PlanPoint point{.position = wanted.position};
    if (placed && has_direction(measured.surface) && is_plane(measured.surface)) {
      const Eigen::Vector3d normal = surface_direction(measured.surface);
      const Eigen::Vector3d to_sensor = sensors[measured.sweep] - measured.position();
      const double facing = normal.dot(to_sensor.normalized());
      if (std::abs(facing) >= kSideIsKnown) {
        point.normal = R_product_keyframe * (facing < 0.0 ? -normal : normal);
      }
    }
    points.push_back(point);
  }
  return points;
}

void visit_plan_points(const MapDatabase& map, const ProductCoordinates& coordinates,
                       const CloudSelection& selection, const TakePlanPoints& take) {
  for (const MapKeyframe& keyframe : map.keyframes()) {
    if (selection.sessions.empty() || selection.sessions.contains(keyframe.session)) {
      take(keyframe, plan_points_of(keyframe, load_submap(map, keyframe.id, map.file()),
                                    coordinates, selection));
    }
  }
}

CutPlane level_cut(double height, double thickness) {
  CutPlane plane{.thickness = thickness};
  plane.T_cut_product.translation().z() = -height;
  return plane;
}

CutPlane upright_cut(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double thickness) {
  CutPlane plane{.thickness = thickness};
  const Eigen::Vector2d along = (to - from).normalized();
  Eigen::Matrix3d rotation;
  rotation << along.x(), along.y(), 0.0, 0.0, 0.0, 1.0, along.y(), -along.x(), 0.0;
  plane.T_cut_product.linear() = rotation;
  plane.T_cut_product.translation() = -rotation * Eigen::Vector3d(from.x(), from.y(), 0.0);
  return plane;
}

std::optional<CutPoint> cut(const CutPlane& plane, const PlanPoint& point) {
  const Eigen::Vector3d p = plane.T_cut_product * point.position;
  if (!(std::abs(p.z()) <= 0.5 * plane.thickness)) {
    return std::nullopt;
  }
  const Eigen::Vector2d normal = (plane.T_cut_product.linear() * point.normal).head<2>();
  const bool is_line = normal.norm() >= kUpright;
  return CutPoint{.place = p.head<2>(),
                  .normal = is_line ? Eigen::Vector2d(normal.normalized())
                                    : Eigen::Vector2d(Eigen::Vector2d::Zero())};
}

}  // namespace adit
