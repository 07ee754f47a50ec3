// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "adit/slam/core/types.hpp"
#include "adit/slam/gnss/world_frame.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

enum class FixVerdict {
  waiting,     ///< the map's place in the world is not known yet
  used,        ///< it ties the map to the world
  thinned,     ///< it says nothing that those beside it do not
  outlier,     ///< it lies elsewhere than the map and the other fixes say
  frozen,      ///< the receiver repeats a position while the sensor moves
  impossible,  ///< it is no position on the Earth
  apart,       ///< its part of the map is tied to the others by nothing
};
/// The enumerator's name.
constexpr std::string_view to_string(FixVerdict verdict) {
  switch (verdict) {
    case FixVerdict::waiting:
      return "waiting";
    case FixVerdict::used:
      return "used";
    case FixVerdict::thinned:
      return "thinned";
    case FixVerdict::outlier:
      return "outlier";
    case FixVerdict::frozen:
      return "frozen";
    case FixVerdict::impossible:
      return "impossible";
    case FixVerdict::apart:
      return "apart";
  }
  return "unknown";
}
inline constexpr std::size_t kFixVerdicts = 7;

/// A GNSS fix with its place in the map, and what became of it.
struct MapFix {
  int64_t id = 0;       ///< counted from 1
  NodeId keyframe = 0;  ///< among whose sweeps it falls
  Nanoseconds stamp{0};
  GnssFixKind kind = GnssFixKind::none;
  Geodetic place;
  /// East north up, m^2, as it counts: the receiver's, but not below what such a fix can have.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// The antenna when the fix was taken, by the odometry, in the keyframe's axes, m: at its stamp,
  /// but where the run's end has found the receiver's delay.
  Eigen::Vector3d p_keyframe_antenna = Eigen::Vector3d::Zero();
  double path = 0.0;  ///< m, that the sensor has gone since the run began
  FixVerdict verdict = FixVerdict::waiting;
  /// What it counts with in the graph, 1/m^2, world axes: less than the covariance says, by what it
  /// shares with those beside it. Zero where it is not used.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double chi2 = 0.0;  ///< of its distance from where the map has it, with `covariance`
  /// The lidar then, by the odometry. A store does not keep it.
  Eigen::Isometry3d T_keyframe_lidar = Eigen::Isometry3d::Identity();
  Vector6d twist = Vector6d::Zero();  ///< as of TrackedMotion; not stored either
};

/// A fix that is used, for the graph.
PositionFix as_measured(const MapFix& fix, const WorldFrame& frame);

}  // namespace adit
