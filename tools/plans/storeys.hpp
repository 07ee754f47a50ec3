// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The floors that a path leads over. A storey is where the path goes: of a floor that was only seen
// nothing is drawn.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"
#include "adit/slam/mapping/map_store.hpp"
#include "adit/tools/plans/plan_points.hpp"

namespace adit {

/// m: storeys are as high at least, a room that people stand in and the slab above it.
inline constexpr double kLeastStorey = 2.2;

/// m, the ground that a lidar sees: beams of -15 degrees reach it at four times the sensor's
/// height.
inline constexpr double kGroundReach = 8.0;

/// A keyframe's place on the floor.
struct FloorStep {
  SessionId session = 0;
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();  ///< m, in the product's coordinates
  /// m, median height of the ground around it; nothing where it saw hardly any.
  std::optional<double> seen_floor{};
  double floor = 0.0;  ///< m, under the sensor; set by floors_under()
};

/// What a keyframe's points say of the floor around it.
FloorStep floor_step(const MapKeyframe& keyframe, const Eigen::Vector3d& sensor,
                     std::span<const PlanPoint> points);

/// The same steps with the floor under each: a session's sensor is carried at one height above the
/// ground, which is the median of what its keyframes say. On stairs, too, where hardly a keyframe
/// sees the step that it is on. A session none of whose keyframes saw ground has no steps here.
std::vector<FloorStep> floors_under(std::vector<FloorStep> steps);

/// A floor and the path on it.
struct Storey {
  double floor = 0.0;   ///< m, median
  double length = 0.0;  ///< m, of the path on it
  std::vector<FloorStep> path{};
};

/// From the lowest to the highest: heights that the path keeps to for 5 m or more, at least 2.2 m
/// apart, and the part of the path that is nearest to each.
std::vector<Storey> find_storeys(std::span<const FloorStep> steps);

/// The height of a storey's floor (m): that under the nearest place of the path, since floors
/// slope, and maps drift.
class StoreyFloor {
 public:
  explicit StoreyFloor(std::vector<FloorStep> path) : path_(std::move(path)) {}

  double at(const Eigen::Vector2d& place);

 private:
  std::vector<FloorStep> path_;
  std::map<std::pair<int64_t, int64_t>, double> known_;  // by square
};

}  // namespace adit
