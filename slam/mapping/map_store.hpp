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
#include <string_view>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/mapping/ground_control.hpp"
#include "adit/slam/mapping/map_fix.hpp"
#include "adit/slam/mapping/pose_graph.hpp"
#include "adit/slam/mapping/vertical.hpp"
#include "adit/slam/mapping/world_frame.hpp"

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

/// What a keyframe has seen, in its own frame.
struct MapSubmap {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  ///< corners of the box around it, m
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();  ///< the upper one
  std::vector<std::vector<std::byte>> chunks;       ///< their content is mapping's own affair
};

/// What became of a candidate.
enum class CandidateVerdict {
  waiting,
  accepted,
  rejected,
  revoked,  ///< accepted once; its edge is revoked
};
/// The enumerator's name.
constexpr std::string_view to_string(CandidateVerdict verdict) {
  switch (verdict) {
    case CandidateVerdict::waiting:
      return "waiting";
    case CandidateVerdict::accepted:
      return "accepted";
    case CandidateVerdict::rejected:
      return "rejected";
    case CandidateVerdict::revoked:
      return "revoked";
  }
  return "unknown";
}

/// How a place that might have been seen before was found.
enum class LoopSource {
  position,    ///< by where the graph has it
  appearance,  ///< by what it looks like
  hand,        ///< somebody knew of it
};
/// The enumerator's name.
constexpr std::string_view to_string(LoopSource source) {
  return source == LoopSource::position     ? "position"
         : source == LoopSource::appearance ? "appearance"
                                            : "hand";
}

/// A place that might have been seen before, and what became of that.
struct LoopCandidate {
  int64_t id = 0;   ///< given by the store
  NodeId from = 0;  ///< earlier keyframe
  NodeId to = 0;    ///< later one
  Eigen::Isometry3d T_from_to =
      Eigen::Isometry3d::Identity();         ///< as verified, or as guessed before
  LoopSource source = LoopSource::position;  ///< how it was found
  double score = 0.0;                        ///< LoopPlace::score that it was found with
  double overlap = 0.0;                      ///< share of the later submap's points with a match
  double chi2 = 0.0;                         ///< correction's; after acceptance that of its edge
  CandidateVerdict verdict = CandidateVerdict::waiting;  ///< what became of it
  std::string reason;                                    ///< the name of a LoopReason
  double rms = 0.0;                                      ///< m, of the matches
  double correction = 0.0;                               ///< m, of the pose that the graph had
  double turn = 0.0;                                     ///< rad
  double through = 0.0;  ///< share of points that the other submap sees through
  double figure = 0.0;   ///< what the reason turns on, see LoopReason; accepted: votes
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
  std::optional<Georeference> georeference{};                  ///< in place of that stored
  bool drops_georeference = false;                             ///< the map has no place any more
  std::optional<std::vector<ControlPoint>> control{};          ///< in place of all those stored
};

/// A place where a map is kept: maps/map_database.hpp is one.
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
  /// used and its control points.
  virtual PoseGraph graph() const = 0;
  /// In order of their ids.
  virtual std::vector<LoopCandidate> candidates() const = 0;
  /// All fixes, used or not, in order of time.
  virtual std::vector<MapFix> fixes() const = 0;
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

}  // namespace adit
