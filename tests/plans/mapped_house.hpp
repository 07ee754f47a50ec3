// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps of houses that tests draw point by point.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <span>

#include <Eigen/Geometry>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit::test {

/// A surface with that normal, as submaps store it.
inline uint32_t surface_facing(const Eigen::Vector3d& normal) {
  constexpr uint32_t kUp = (1U << 30U) | (16383U << 15U) | 16383U;
  return turned_surface(
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix(), kUp);
}

/// Adds a point (map frame, m) to the submap of a keyframe at `sensor` without rotation.
inline void add_point(KeyframeSubmap& submap, const Eigen::Vector3d& sensor,
                      const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                      bool moved = false) {
  const Eigen::Vector3d at = (point - sensor) * kSubmapSteps;
  submap.points.push_back({.place = {static_cast<int32_t>(std::lround(at.x())),
                                     static_cast<int32_t>(std::lround(at.y())),
                                     static_cast<int32_t>(std::lround(at.z()))},
                           .surface = surface_facing(normal),
                           .seen_through = moved});
}

/// Writes a map whose keyframes are at the sensors' places (m); `draw` adds the points of each.
inline void write_house(
    const std::filesystem::path& file, std::span<const Eigen::Vector3d> sensors,
    const std::function<void(KeyframeSubmap&, const Eigen::Vector3d&, NodeId)>& draw) {
  MapDatabase map(file, MapAccess::write);
  const SessionId session = map.add_session({.name = "house"});
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const auto id = static_cast<NodeId>(i);
    const std::chrono::seconds stamp(100 + id);
    KeyframeSubmap submap;
    submap.r_submap = 0.1;
    submap.vertical = Vertical::gravity;
    submap.sweeps = {{.stamp = stamp, .merged = true}};
    draw(submap, sensors[i], id);
    std::ranges::sort(submap.points, {}, &SubmapPoint::place);
    KeyframeRecord record{
        .keyframe = {.id = id,
                     .session = session,
                     .stamp = stamp,
                     .T_map_keyframe = Eigen::Isometry3d(Eigen::Translation3d(sensors[i]))},
        .submap = encode(submap)};
    if (i > 0) {
      const Eigen::Vector3d way = sensors[i] - sensors[i - 1];
      record.edges.push_back(
          {.from = id - 1, .to = id, .T_from_to = Eigen::Isometry3d(Eigen::Translation3d(way))});
    }
    map.store(record);
  }
}

}  // namespace adit::test
