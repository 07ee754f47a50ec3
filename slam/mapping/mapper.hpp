// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/graph/keyframe_edge.hpp"
#include "adit/slam/graph/map_shares.hpp"
#include "adit/slam/mapping/map_assembly.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/slam/registration/batch_aligner.hpp"
#include "adit/slam/submaps/submap_builder.hpp"

namespace adit {

/// Where the map sees a sweep.
struct MapPlacement {
  NodeId keyframe = 0;                                            ///< whose submap it belongs to
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();  ///< as far as is known by now
  Localization localization{};  ///< as the last stored keyframe has it
};

/// What has become of a run's map.
struct MapReport {
  std::size_t keyframes = 0;      ///< stored
  std::size_t sweeps = 0;         ///< placed in them
  std::size_t edges = 0;          ///< between keyframes
  std::size_t aligned_edges = 0;  ///< the submaps could be aligned; the others are odometry alone
  std::size_t components = 0;     ///< parts of the map that nothing ties together
  /// The graph has outgrown its memory with it (MapMemory), and is optimised no more.
  std::optional<NodeId> outgrown{};
  uint64_t points = 0;              ///< total over all submaps
  uint64_t seen_through = 0;        ///< of them, which have moved: docs/theory/mapping.md
  uint64_t lost_points = 0;         ///< lay too far from their keyframe for its cells
  uint64_t crowded_cells = 0;       ///< of submaps: the mean of their points is lost
  std::vector<float> keyframe_ms;   ///< host time per keyframe, with its waits for the device
  double waited_s = 0.0;            ///< that sweeps have waited for the map in all; the executor's.
                                    ///< Without its set-up before the first and its end
  double longest_wait_s = 0.0;      ///< of one sweep
  std::optional<LoopReport> loops;  ///< none: not looked for
  GnssReport gnss;                  ///< what became of fixes
  Localization localization{};      ///< of the last keyframe
  /// At the run's end; none where loops, fixes and headings have no part in the map.
  std::optional<MapShares> shares{};
};

/// Makes a map of what the odometry has placed: keyframes with their submaps go to the store, edges
/// between consecutive ones into the pose graph. The odometry never learns of it. No submap spans a
/// silence of the sensors: the edge over it is the odometry's alone, with the covariance of what is
/// known.
///
/// A keyframe's work takes effect when `mapping.delay` more have followed, or at finish(): when it
/// is really done makes no difference to any result.
class Mapper {
 public:
  /// What the constructor is given must outlive it; `config` must have passed validate().
  /// The session is tied to what `earlier` says of the store, and expected to begin at `start`.
  Mapper(engine::Context& context, const Config& config, MapStore& store, SessionId session,
         const MapMemory& memory = {}, EarlierSessions earlier = EarlierSessions::none,
         const std::optional<StartPlace>& start = {});

  /// The sweep belongs to a new keyframe, if its result says so, or else to the last one. `cloud`
  /// is its down-sampled cloud, lidar axes. What the store throws comes through.
  MapPlacement add(const Sweep& sweep, const SweepResult& result, std::span<const Point> cloud);

  /// A fix of the antenna at that place of the lidar's axes (m). It counts once the sweeps before
  /// and after it have come, whose poses by the odometry tell where it was taken.
  void add(const GnssFix& fix, const Eigen::Vector3d& p_lidar_antenna);
  /// A heading of an axis that points that way in the lidar's axes, likewise.
  void add(const Heading& heading, const Eigen::Vector3d& axis_lidar);

  /// The last keyframe is stored, everything takes effect, and final poses go to the store.
  void finish();

  /// As it is by now.
  const PoseGraph& graph() const { return assembly_.graph(); }
  /// As it is by now.
  const MapReport& report() const { return report_; }

 private:
  /// The keyframe whose submap grows.
  struct Open {
    NodeId id = 0;
    UncertainPose lidar;                 ///< pose of its first sweep, in the odometry's frame
    bool detached = false;               ///< the odometry started anew with it
    bool after_silence = false;          ///< the odometry found its track again with it
    std::vector<MapFix> fixes{};         ///< antenna and lidar in the odometry's frame as yet
    std::vector<MapHeading> headings{};  ///< axis in the odometry's frame as yet
  };
  struct PendingFix {
    GnssFix fix;
    Eigen::Vector3d p_lidar_antenna;
  };
  struct PendingHeading {
    Heading heading;
    Eigen::Vector3d axis_lidar;
  };
  /// One that is stored.
  struct Frozen {
    NodeId id = 0;
    UncertainPose lidar;
    Eigen::Isometry3d T_odom_keyframe = Eigen::Isometry3d::Identity();
    AlignmentTarget target;
    bool has_points = false;
  };
  bool is_placed_by(const SweepResult& next) const;
  void place_fixes(const SweepResult& next);
  void place_headings(const SweepResult& next);
  void freeze();
  PoseEdge tie(const Frozen& from, const Open& to, const FrozenSubmap& submap,
               const SurfaceCloud& cloud);

  engine::Context* context_;
  Config config_;
  MapStore* store_;
  SessionId session_;
  double beam_spacing_;
  SubmapBuilder builder_;
  AlignmentClouds clouds_;
  BatchAligner aligner_;
  MapAssembly assembly_;
  std::optional<StartPlace> start_;  ///< until the first sweep has come
  std::optional<Open> open_;
  std::optional<Frozen> last_;
  NodeId next_ = 0;
  std::deque<PendingFix> pending_;               ///< in the order of their stamps
  std::deque<PendingHeading> pending_headings_;  ///< likewise
  /// The sweep before, for what is between it and the next.
  std::optional<StampedPose> last_pose_;
  double path_ = 0.0;          ///< m, up to that sweep
  bool has_receiver_ = false;  ///< that has had a position
  int64_t next_fix_ = 1;
  Nanoseconds last_sweep_{0};  ///< its stamp
  MapReport report_;
};

}  // namespace adit
