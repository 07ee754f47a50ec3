// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a page is told of a map besides its points, as JSON: tools/viewer/page/protocol.ts is the
// other side.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/core/types.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// The time that a scene counts from and how long it lasts.
struct ViewSpan {
  Nanoseconds first{0};
  Nanoseconds last{0};

  double seconds_of(Nanoseconds stamp) const { return seconds(stamp - first); }
  /// From 0 to 65535: TilePointFacts::moment.
  uint16_t moment_of(Nanoseconds stamp) const;
};

/// A sweep and where its sensor was: in the keyframe's axes, or in the map's for keyframe -1.
struct ViewSweep {
  Nanoseconds stamp{0};
  int64_t keyframe = -1;  ///< position among keyframes()
  Eigen::Isometry3d T_keyframe_lidar = Eigen::Isometry3d::Identity();
};

/// The truth laid over a map.
struct ViewTruth {
  std::map<NodeId, double> errors;    ///< m, of keyframes that it covers
  std::vector<Eigen::Vector3d> path;  ///< in the map's frame, m
};

/// The sweeps of a map in the order of keyframes. Throws InputError where a submap is damaged.
std::vector<ViewSweep> sweeps_of(const MapDatabase& map);

/// "graph": keyframes with poses and covariances in the map's axes (m^2), what the odometry alone
/// says of their poses, edges, loops with verdicts and reasons, GNSS fixes where the map has its
/// place on the Earth, the truth where it is known. Throws InputError.
nlohmann::ordered_json graph_of(const MapDatabase& map, const ViewSpan& span,
                                const std::optional<ViewTruth>& truth = std::nullopt);

/// The graph of what has no keyframes.
nlohmann::ordered_json no_graph();

/// x, y, z (m) and quaternion x, y, z, w of each, one after the other.
nlohmann::ordered_json poses_of(const std::vector<Eigen::Isometry3d>& poses);
nlohmann::ordered_json poses_of(const std::vector<MapKeyframe>& keyframes);

/// Of so many sweeps, one in so many is told.
std::size_t stride_of(std::size_t sweeps);

/// "sweeps": evenly thinned to 65535 of them.
nlohmann::ordered_json json_of(const std::vector<ViewSweep>& sweeps, const ViewSpan& span);

/// On one line; what is no UTF-8 is replaced.
std::string text_of(const nlohmann::ordered_json& json);

}  // namespace adit
