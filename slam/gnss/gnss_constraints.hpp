// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/slam/gnss/antenna_calibration.hpp"
#include "adit/slam/gnss/heading_constraints.hpp"
#include "adit/slam/gnss/map_fix.hpp"
#include "adit/slam/gnss/odometry_track.hpp"
#include "adit/slam/gnss/receiver_jump.hpp"
#include "adit/slam/gnss/world_fit.hpp"
#include "adit/slam/gnss/world_frame.hpp"

namespace adit {

/// Fewer fixes place no map without headings.
inline constexpr std::size_t kFewestFixes = 5;

/// Turns a map so that its levelled nodes are level, by their mean.
Eigen::Matrix3d levelling(const PoseGraph& graph);

/// What fixes tell of where their antenna sits and of how late they are.
struct AntennaReport {
  bool estimated = false;  ///< false: too few fixes, or the map has no place in the world
  /// The lever arm's error along the lidar's x, y and z (m), and the delay (s): beyond what the
  /// settings have.
  std::array<AntennaParameter, 4> parameters{};
  bool corrected = false;    ///< what is significant is, and the map agrees better with the fixes
  double cost_before = 0.0;  ///< sum of chi squared of graph and fixes, where it was tried
  double cost_after = 0.0;
  /// As it was given or is now, m, lidar axes.
  Eigen::Vector3d p_lidar_antenna = Eigen::Vector3d::Zero();
  double time_offset = 0.0;  ///< s, that stamps are corrected by: the setting's, or as it is now

  /// One of the parameters is beyond doubt.
  bool any_significant() const {
    return std::ranges::any_of(parameters, &AntennaParameter::significant);
  }
};

/// What has become of a run's GNSS fixes.
struct GnssReport {
  std::size_t fixes = 0;             ///< with a position, among the map's sweeps
  std::size_t without_position = 0;  ///< the receiver had none
  std::size_t outside = 0;           ///< before the first sweep, after the last or in a gap
  std::size_t left_out = 0;          ///< without a finite latitude and longitude
  std::array<std::size_t, kFixVerdicts> verdicts{};  ///< by FixVerdict
  std::optional<Georeference> georeference{};        ///< none: the fixes do not tell it
  double extent = 0.0;      ///< m, between the places that are farthest apart, along x or y
  double yaw_sigma = 0.0;   ///< rad, where a fit was found; 0: none
  double horizontal = 0.0;  ///< m, rms of what is left of used fixes
  double vertical = 0.0;
  /// Squared, a degree of freedom, mean over used fixes: their distance from where the map has them
  /// over its covariance.
  double innovation_squared = 0.0;
  std::size_t heights = 0;   ///< used fixes with an altitude; 0: the map's altitude is a guess
  std::size_t asked = 0;     ///< fixes that could agree on a place, where many do not
  std::size_t agreeing = 0;  ///< and those of them that do
  std::optional<ReceiverJump> jump{};  ///< that explains it; times from the first fix on
  bool swapped = false;  ///< with latitude and longitude exchanged the fixes would agree
  std::size_t optimizations = 0;
  double level_drift_scale = 1.0;  ///< of the last one (LoopOptimum)
  AntennaReport antenna{};
  HeadingReport heading{};

  /// There was a receiver at all.
  bool any() const { return fixes + without_position + outside + left_out > 0; }
};

/// Ties a map to the world by GNSS fixes: looks for its place until that is known well enough,
/// judges each fix by where the map has it, and optimises the graph with those that agree
/// (docs/theory/gnss.md). The map's first node stays where it is: what moves is T_world_map, and
/// the map in itself by as much as the fixes correct of its drift. Headings, which a map may have
/// besides, count where fixes and odometry do not contradict them.
class GnssConstraints {
 public:
  explicit GnssConstraints(const GnssConfig& config) : config_(config), headings_(config) {}

  /// The graph begins with nodes of earlier sessions, whose fixes these are in the order of their
  /// ids, with the headings that are used, and perhaps with a place in the world. Only before all
  /// else.
  void begin_behind(std::vector<MapFix> fixes, std::vector<MapHeading> headings,
                    const std::optional<Georeference>& georeference);

  /// Of a node that the graph will have, in the order of their times.
  void add(std::span<const MapFix> fixes);
  /// Likewise.
  void add(std::span<const MapHeading> headings) { headings_.add(headings); }
  void count_headings_outside(std::size_t headings) { headings_.count_outside(headings); }
  /// Of the lidar in the odometry's frame, a sweep each; `anew` as of OdometryTrack.
  void add_pose(const StampedPose& pose, bool anew) { track_.add(pose, anew); }
  void count_without_position() { ++report_.without_position; }
  void count_outside(std::size_t fixes) { report_.outside += fixes; }

  /// What a step has changed.
  struct Change {
    std::vector<MapFix> fixes;  ///< those with another verdict, residual or weight
    /// All that are used, at the end; none: they are as before.
    std::optional<std::vector<MapHeading>> headings{};
    std::optional<Georeference> georeference{};
    bool place_is_lost = false;  ///< later fixes contradict it
    bool moved = false;          ///< the graph has other poses
  };
  /// The fixes of nodes up to `keyframe` take effect.
  Change take_effect(PoseGraph& graph, NodeId keyframe, bool may_optimize = true);
  /// All do, and those judged before are judged again.
  Change finish(PoseGraph& graph, bool may_optimize = true);

  const GnssReport& report() const { return report_; }

 private:
  bool has_news(NodeId keyframe) const;
  void set_verdict(std::size_t fix, FixVerdict verdict);
  void set_chi2(std::size_t fix, double chi2);
  std::size_t count(FixVerdict verdict) const;
  bool is_repeated(std::size_t fix) const;
  bool is_near_the_last(std::size_t fix) const;
  double distance2(const PoseGraph& graph, const MapFix& fix, double drift) const;
  void judge_new(const PoseGraph& graph, NodeId last);
  bool judge_again(const PoseGraph& graph, double gate_of_used);
  std::vector<std::size_t> told_by(const PoseGraph& graph);
  std::vector<PositionPair> pairs_of(const PoseGraph& graph, std::span<const std::size_t> part,
                                     const WorldFrame& frame, bool swapped) const;
  WorldFrame middle_frame(std::vector<std::size_t> part) const;
  void look_for_jump(const PoseGraph& graph);
  std::optional<WorldFit> fit(const PoseGraph& graph, std::span<const std::size_t> part,
                              const WorldFrame& frame, bool swapped) const;
  /// What a place has to have for it to be known.
  struct PlaceNeeds {
    double agreement = 0.5;            ///< of the fixes that have been seen by then
    double yaw_sigma = 1.0 * kDegree;  ///< rad
  };
  bool find_place(PoseGraph& graph, const PlaceNeeds& needs);
  void assess_headings(PoseGraph& graph);
  bool place_by_headings(PoseGraph& graph);
  bool look_for_place(PoseGraph& graph);
  bool is_contradicted() const;
  void forget_place(PoseGraph& graph);
  bool would_agree_exchanged(const PoseGraph& graph);
  void tie(PoseGraph& graph);
  void optimize(PoseGraph& graph);
  void settle(PoseGraph& graph);
  void calibrate_antenna(PoseGraph& graph);
  std::optional<AntennaEstimate> antenna_estimate(const PoseGraph& graph);
  std::optional<AntennaEstimate> correct_significant(PoseGraph& graph, AntennaEstimate estimate);
  void correct_antenna(const AntennaError& error);
  void judge_by(const AntennaEstimate& estimate, const PoseGraph& graph);
  /// What the odometry's covariances count times, as in LoopOptimum.
  struct OdometryScales {
    double all = 1.0;
    double horizontal_drift = 1.0;
  };
  double cost(const PoseGraph& graph, const OdometryScales& scales);
  bool most_agree() const;
  void measure(const PoseGraph& graph);
  Change take_change(const PoseGraph& graph, bool moved, bool had_place);

  GnssConfig config_;
  std::vector<MapFix> fixes_;
  std::size_t earlier_ = 0;               ///< of fixes_, from the first: of earlier sessions
  std::set<std::size_t> changed_;         ///< of fixes_, since the last change was taken
  std::size_t judged_ = 0;                ///< of fixes_, from the first
  std::size_t tried_ = 0;                 ///< how many there were when the place was looked for
  std::optional<std::size_t> last_kept_;  ///< the latest fix that is neither thinned nor frozen
  std::optional<WorldFrame> frame_;
  HeadingConstraints headings_;
  std::size_t assessed_ = 0;           ///< how many fixes there were when the headings were judged
  std::size_t assessed_headings_ = 0;  ///< and how many of these
  bool placed_by_headings_ = false;    ///< frame_ is; fixes alone do not give the place yet
  double optimized_path_ = 0.0;        ///< m, of the last used fix in the last optimisation
  std::size_t optimized_nodes_ = 0;
  std::size_t used_since_ = 0;
  OdometryScales odometry_scales_;  ///< of the last optimisation
  OdometryTrack track_;
  double delay_ = 0.0;  ///< s, of the stamps, that places of fixes are corrected by
  GnssReport report_;
};

}  // namespace adit
