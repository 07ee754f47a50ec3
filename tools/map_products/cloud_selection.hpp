// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Points of a map on their way into products, and which of them are wanted.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/mapping/map_store.hpp"
#include "adit/tools/clouds/las_layout.hpp"

namespace adit {

class MovedSpace;

/// A point with what is known of it. Submaps keep neither intensity nor ring: 0.
struct CloudPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, in the product's coordinates
  /// When it was measured; of a submap's point the stamp of the sweep whose sensor was nearest.
  Nanoseconds time{0};
  float intensity = 0.0F;  ///< the sensor's own scale
  uint16_t ring = 0;       ///< beam
  NodeId keyframe = 0;
  SessionId session = 0;
  bool moving = false;  ///< other sweeps or submaps saw through it
  /// Ground or noise, as far as it is looked for.
  LasClass classification = LasClass::unclassified;
  std::array<uint8_t, 3> color{};  ///< red, green, blue; black where no camera saw it
};
/// Of no surface of the place: low or high noise, mixed, the carrier.
bool is_noise(LasClass one);
/// Its classification; what moves is of the class `moving`.
LasClass class_of(const CloudPoint& point);
using TakeCloud = std::function<void(std::span<const CloudPoint>)>;

/// What is wanted; everything unless something is said.
struct CloudSelection {
  std::set<SessionId> sessions{};      ///< empty: all
  std::optional<Nanoseconds> from{};   ///< stamps
  std::optional<Nanoseconds> until{};  ///< including it
  /// Corners in the product's coordinates, m, in either sense; empty: everywhere.
  std::vector<Eigen::Vector2d> polygon{};
  bool without_moving = false;
  /// Map frame: what is in it is moving, besides what each submap knows. Null: not looked for.
  std::shared_ptr<const MovedSpace> moved{};
  /// Points (map frame, m) of sessions that are left out, as what they were of is gone since.
  /// Empty: none.
  std::function<bool(const Eigen::Vector3d& point, SessionId session)> is_gone{};
  /// The class of a point by its place in the map's frame and in the product's coordinates, m.
  /// Empty: all are unclassified.
  std::function<LasClass(const Eigen::Vector3d& in_map, const Eigen::Vector3d& in_product)>
      class_at{};
  /// Mixed pixels and the carrier are looked for in the sweeps of a dense cloud.
  bool looks_at_sweeps = false;
  /// What is noise or moves is left out by whoever takes the points, and stands for no others.
  bool drops_noise = false;
};
/// Gives the point, which is at `in_map` (m) in the map's frame, its class. Ground does not move,
/// what stood on it did; and a point that is alone is no object.
void classify(const CloudSelection& selection, const Eigen::Vector3d& in_map, CloudPoint& point);
/// Whether the point is left out later.
bool is_dropped(const CloudSelection& selection, const CloudPoint& point);

/// Whether the point of the map (m) has moved, as far as was looked.
bool has_moved(const CloudSelection& selection, const Eigen::Vector3d& point);
/// By session and time: a keyframe or sweep as a whole.
bool is_wanted(const CloudSelection& selection, SessionId session, Nanoseconds stamp);
bool is_wanted(const CloudSelection& selection, const CloudPoint& point);

/// Inside, by the number of sides that a ray to the east crosses.
bool is_within(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point);

}  // namespace adit
