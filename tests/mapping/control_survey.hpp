// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A map that has drifted, and surveyed points of what it shows.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/gnss/ground_control.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit::test {

inline constexpr NodeId kSurveyed = 21;  // keyframes, 10 m apart: the map has them in a line

/// What was surveyed of it.
struct Survey {
  struct Mark {
    std::string name;
    ControlRole role = ControlRole::control;
    NodeId keyframe = 0;
    Eigen::Vector3d p_keyframe{0.2, 1.1, 1.9};
    Eigen::Vector3d mistake = Eigen::Vector3d::Zero();  ///< east, north, up of its place, m
  };

  WorldFrame frame{{.latitude = 46.5, .longitude = 8.25, .altitude = 1200.0}};
  std::vector<Mark> marks;

  /// Control at every fifth keyframe, checks between.
  Survey() {
    for (NodeId id = 0; id < kSurveyed; id += 5) {
      marks.push_back({.name = fmt::format("C{}", id), .keyframe = id});
    }
    for (const NodeId id : {3, 8, 12, 18}) {
      marks.push_back({.name = fmt::format("K{}", id), .role = ControlRole::check, .keyframe = id});
    }
  }

  /// Where the keyframe really is: the way bends by 0.1 degrees and climbs by 1 cm a keyframe.
  static Eigen::Isometry3d T_world_keyframe(NodeId id) {
    Eigen::Isometry3d pose = step(0.0, 0.7);
    pose.translation() << 30.0, -20.0, 5.0;
    for (NodeId i = 0; i < id; ++i) {
      Eigen::Isometry3d way = step(10.0, 0.0017);
      way.translation().z() = 0.01;
      pose = pose * way;
    }
    return pose;
  }

  Geodetic place(const Mark& mark) const {
    return frame.place_of(T_world_keyframe(mark.keyframe) * mark.p_keyframe + mark.mistake);
  }

  std::vector<ControlPoint> points() const {
    std::vector<ControlPoint> points;
    for (const Mark& mark : marks) {
      points.push_back(
          {.name = mark.name,
           .role = mark.role,
           .keyframe = mark.keyframe,
           .p_keyframe = mark.p_keyframe,
           .p_marked = step(10.0 * static_cast<double>(mark.keyframe)) * mark.p_keyframe,
           .place = place(mark)});
    }
    return points;
  }

  /// As a user writes it.
  std::string table() const {
    std::string text = "name,role,x_m,y_m,z_m,latitude_deg,longitude_deg,altitude_m\n";
    for (const Mark& mark : marks) {
      const Eigen::Vector3d p = step(10.0 * static_cast<double>(mark.keyframe)) * mark.p_keyframe;
      const Geodetic at = place(mark);
      text +=
          fmt::format("{},{},{},{},{},{:.12f},{:.12f},{:.6f}\n", mark.name, to_string(mark.role),
                      p.x(), p.y(), p.z(), at.latitude, at.longitude, at.altitude);
    }
    return text;
  }
};

inline void store_surveyed(const std::filesystem::path& file) {
  MapDatabase map(file, MapAccess::write);
  const SessionId session = add_session(map);
  for (NodeId id = 0; id < kSurveyed; ++id) {
    map.store(record_of_a_point(id, session));
  }
}

}  // namespace adit::test
