// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/gnss/gnss_constraints.hpp"
#include "adit/slam/loops/loop_closer.hpp"
#include "adit/slam/mapping/localization.hpp"
#include "adit/slam/mapping/map_store.hpp"
#include "adit/slam/mapping/start_place.hpp"
#include "adit/slam/mapping/stored_map.hpp"
#include "adit/slam/submaps/map_memory.hpp"

namespace adit {

/// A keyframe with all that the odometry and its submap say.
struct AssembledKeyframe {
  MapKeyframe keyframe;  ///< without its pose in the map
  Eigen::Isometry3d T_odom_keyframe = Eigen::Isometry3d::Identity();
  const KeyframeSubmap* submap = nullptr;
  const SurfaceCloud* cloud = nullptr;  ///< the submap on the device
  std::optional<PoseEdge> edge{};       ///< from the one before; none: nothing ties it to that
  std::vector<MapFix> fixes{};          ///< in the order of their times
  std::vector<MapHeading> headings{};   ///< likewise
};

/// What a session counts on from: behind those of earlier sessions.
struct SessionStart {
  NodeId keyframe = 0;  ///< id of its first
  int64_t fix = 1;      ///< id of its first
  double path = 0.0;    ///< m, that MapFix::path is counted from
};

/// Puts keyframes together to a map: edges and loops take effect after the delay, the graph is
/// corrected, and all of it goes to the store.
class MapAssembly {
 public:
  /// What the constructor is given must outlive it. A graph that has outgrown `memory` is optimised
  /// no more. What comes is tied to what `earlier` says of the store.
  MapAssembly(engine::Context& context, const Config& config, MapStore& store,
              const MapMemory& memory, EarlierSessions earlier = EarlierSessions::none);

  /// The session is expected to begin there. Before its first keyframe; without earlier sessions it
  /// has no effect.
  void begin_at(const ExpectedStart& start);

  /// The next keyframe. What the store throws comes through.
  void add(const AssembledKeyframe& added);
  /// Everything takes effect, and final poses go to the store.
  void finish();

  /// Where the session begins.
  const SessionStart& start() const { return start_; }
  /// Where the newest keyframe is in the map of earlier sessions.
  const Localization& localization() const { return localization_; }

  const Eigen::Isometry3d& T_map_odom() const { return T_map_odom_; }
  const PoseGraph& graph() const { return graph_; }
  /// By its number, with which the graph has outgrown the memory.
  std::optional<NodeId> outgrown() const { return outgrown_; }
  /// Rms distance (m) in an alignment of consecutive submaps.
  void add_expected_rms(double rms);
  /// None: loops are not looked for.
  std::optional<LoopReport> loops() const;
  /// Fixes that have no place in the map, for the report.
  GnssConstraints& world() { return world_; }

 private:
  struct Due {
    NodeId at = 0;  ///< the keyframe with which it takes effect
    NodeId keyframe = 0;
    std::optional<PoseEdge> edge;  ///< that leads to the keyframe
    std::vector<PendingLoop> loops{};
  };

  bool can_optimize() const { return memory_.can_optimize(graph_.nodes().size()); }
  PoseGraph known_graph() const;
  void take_effect(NodeId until);
  void close_loops(const LoopCloser::Change& change, std::size_t last_tied);
  void tie_to_world(const GnssConstraints::Change& change, std::size_t last_tied);
  void follow(std::size_t last_tied);
  void settle();
  void begin_behind(StoredMap earlier, const GnssConfig& gnss);
  void tie_start(const Matrix6d& covariance);
  void start_by_fixes(const AssembledKeyframe& added);
  void release_start();
  void localize();
  double odometry_path(std::size_t from, std::size_t to) const;

  MapStore* store_;
  MapMemory memory_;
  int delay_;  ///< keyframes
  std::optional<LoopCloser> loops_;
  GnssConstraints world_;
  PoseGraph graph_;
  std::vector<Eigen::Isometry3d> T_odom_keyframes_;  ///< in the order of the graph's nodes
  Eigen::Isometry3d T_map_odom_ = Eigen::Isometry3d::Identity();
  std::deque<Due> due_;
  std::optional<NodeId> outgrown_;
  EarlierSessions earlier_;
  bool uses_fixes_ = true;
  std::optional<Georeference> georeference_{};  ///< of the earlier sessions
  std::size_t earlier_nodes_ = 0;
  SessionStart start_;
  std::optional<Matrix6d> start_covariance_{};    ///< of the first keyframe, which has not come yet
  std::optional<std::size_t> start_edge_{};       ///< of the graph; while it may count
  std::optional<StartByFixes> start_by_fixes_{};  ///< until a start is known
  Localization localization_;
};

}  // namespace adit
