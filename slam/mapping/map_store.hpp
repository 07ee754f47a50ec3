// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What mapping asks of the place where a map is kept. Who implements it returns from a call that
// stores only once a loss of power could not take back what was stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/gnss/ground_control.hpp"
#include "adit/slam/gnss/map_fix.hpp"
#include "adit/slam/gnss/map_heading.hpp"
#include "adit/slam/gnss/world_frame.hpp"
#include "adit/slam/graph/pose_graph.hpp"
#include "adit/slam/graph/vertical.hpp"
#include "adit/slam/loops/loop_candidate.hpp"
#include "adit/slam/submaps/map_submap.hpp"

namespace adit {

/// Of a session, unique in a map.
using SessionId = int64_t;

/// One recording's share of a map.
struct MapSession {
  SessionId id = 0;             ///< given by the store
  std::string name;             ///< for people
  std::string configuration{};  ///< TOML, as `adit config` prints it
  /// Where the session comes from: names and values such as input hashes, device, driver, version.
  std::vector<std::pair<std::string, std::string>> provenance{};
};

/// A node of the graph with the sweep it belongs to.
struct MapKeyframe {
  NodeId id = 0;                                                     ///< of its node in the graph
  SessionId session = 0;                                             ///< whose share it belongs to
  Nanoseconds stamp{0};                                              ///< of its sweep
  Eigen::Isometry3d T_map_keyframe = Eigen::Isometry3d::Identity();  ///< as last optimised
  bool fixed = false;                      ///< the optimisation leaves it where it is
  Matrix6d covariance = Matrix6d::Zero();  ///< the pose's, [rho, phi]: m^2, rad^2
  Vertical vertical = Vertical::unknown;   ///< its submap's
};

/// Everything that comes with a new keyframe; it is stored as a whole or not at all.
struct KeyframeRecord {
  MapKeyframe keyframe;                     ///< the new one
  MapSubmap submap{};                       ///< what it has seen
  std::vector<PoseEdge> edges{};            ///< to earlier ones
  std::vector<LoopCandidate> candidates{};  ///< new ones
  std::vector<MapFix> fixes{};              ///< fixes since the last keyframe
};

/// What changes in a map besides new keyframes.
struct MapRevision {
  std::vector<PoseEdge> edges{};            ///< new ones
  std::vector<LoopCandidate> candidates{};  ///< those with the id of a stored one replace it
  std::vector<std::pair<std::size_t, EdgeStatus>> statuses{};  ///< new ones of stored edges
  std::vector<PoseNode> poses{};                               ///< new ones of stored keyframes
  std::vector<MapFix> fixes{};                                 ///< in place of those stored
  std::optional<std::vector<MapHeading>> headings{};           ///< in place of all those stored
  std::optional<Georeference> georeference{};                  ///< in place of that stored
  bool drops_georeference = false;                             ///< the map has no place any more
  std::optional<std::vector<ControlPoint>> control{};          ///< in place of all those stored
};

/// A place where a map is kept: map_database/map_database.hpp is one.
class MapStore {
 public:
  virtual ~MapStore() = default;

  /// The number that the store gave it; `session.id` is passed over.
  virtual SessionId add_session(const MapSession& session) = 0;
  /// As a whole or not at all.
  virtual void store(const KeyframeRecord& record) = 0;
  /// As a whole or not at all.
  virtual void revise(const MapRevision& revision) = 0;
  /// What follows ends the map, whose last sweep has that stamp; a run that goes on with it later
  /// takes that back first.
  virtual void begin_end(Nanoseconds last_sweep) = 0;

  /// In order of their ids.
  virtual std::vector<MapSession> sessions() const = 0;
  /// In order of their ids.
  virtual std::vector<MapKeyframe> keyframes() const = 0;
  /// Edges in the order in which they were stored: MapRevision::statuses counts them so. Tied to
  /// the world by the verticals of keyframes and, where the map has its place there, by the fixes
  /// and headings used and its control points.
  virtual PoseGraph graph() const = 0;
  /// In order of their ids.
  virtual std::vector<LoopCandidate> candidates() const = 0;
  /// All fixes, used or not, in order of time.
  virtual std::vector<MapFix> fixes() const = 0;
  /// The headings that are used, in the order in which they were given.
  virtual std::vector<MapHeading> headings() const { return {}; }
  /// Where the map lies on the Earth; nothing: unknown.
  virtual std::optional<Georeference> georeference() const = 0;
  /// What a keyframe has seen, all chunks of it.
  virtual MapSubmap submap(NodeId keyframe) const = 0;
  /// One chunk of it alone, the first is 0.
  virtual std::vector<std::byte> chunk(NodeId keyframe, std::size_t number) const = 0;
  /// Keyframes whose submaps may reach into a box of the map frame (m), in order of ids.
  virtual std::vector<NodeId> submaps_within(const Eigen::Vector3d& lower,
                                             const Eigen::Vector3d& upper) const = 0;
};

/// Reads submaps from `store`, which must outlive it.
inline SubmapLoader submap_loader(const MapStore& store) {
  return [&store](NodeId keyframe) { return store.submap(keyframe); };
}

}  // namespace adit
