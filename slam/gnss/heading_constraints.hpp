// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/gnss/map_heading.hpp"
#include "adit/slam/gnss/world_frame.hpp"

namespace adit {

/// The standard deviation that a heading counts with, rad: as stated, but not below 0.2 degrees,
/// what two antennas a metre apart measure at best; gnss.heading_sigma where none is stated.
double heading_deviation(const Heading& heading, const GnssConfig& config);

/// A yaw of the map in the world, rad.
struct MapYaw {
  double yaw = 0.0;
  double sigma = 0.0;
};

/// A map in the world, as far as is known.
struct PlacedMap {
  const WorldFrame* frame = nullptr;  ///< null: unknown
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();
};

/// Judges a source of headings and its headings (docs/theory/gnss.md): by the odometry's turns,
/// which tell whether they agree with each other, and by the yaw that fixes give the map. Nothing
/// of it is remembered from one assessment to the next, so that a source which was wrongly refused
/// is used once more fixes are known.
class HeadingConstraints {
 public:
  explicit HeadingConstraints(const GnssConfig& config) : config_(config) {}

  /// Those of earlier sessions that are used: they count as they did, and are not judged again.
  void begin_behind(std::vector<MapHeading> headings) { earlier_ = std::move(headings); }

  /// Of a node that the graph will have, in the order of their times.
  void add(std::span<const MapHeading> headings);
  void count_outside(std::size_t headings) { report_.outside += headings; }
  bool any() const { return !headings_.empty(); }
  /// How many have been judged by themselves.
  std::size_t judged() const { return judged_; }
  /// Of a node up to that one there are some that are not judged yet.
  bool has_new(NodeId last) const {
    return judged_ < headings_.size() && headings_[judged_].keyframe <= last;
  }

  /// Those of nodes up to `last`, each by itself.
  void judge_new(const PoseGraph& graph, NodeId last);

  /// The source and all headings judged so far. `levelling` turns the map so that z is up;
  /// `by_fixes` is the yaw of the map so turned, where fixes alone give one; `place` is for the
  /// meridians' convergence.
  void assess(const PoseGraph& graph, const Eigen::Matrix3d& levelling, const PlacedMap& place,
              const std::optional<MapYaw>& by_fixes);

  /// The yaw of the levelled map, by the last assessment. None: they do not tell it, or are
  /// refused.
  const std::optional<MapYaw>& yaw() const { return yaw_; }

  /// The used ones with what they count with. All of a session together count as one heading with
  /// the error that they have in common (gnss.heading_offset) at the most.
  std::vector<MapHeading> used(const PoseGraph& graph) const;

  /// After an optimisation, when the map is where all want it.
  void judge_again(const PoseGraph& graph, const WorldFrame& frame);
  /// The map has no place any more.
  void forget_place();
  void set_placed() { report_.placed = true; }

  const HeadingReport& report() const { return report_; }

 private:
  bool is_frozen(const PoseGraph& graph, std::size_t heading);
  std::vector<std::size_t> part_of(const PoseGraph& graph);
  void set_verdict(std::size_t heading, HeadingVerdict verdict);
  std::vector<double> shares_of(std::span<const std::size_t> part) const;

  GnssConfig config_;
  std::vector<MapHeading> earlier_;
  std::vector<MapHeading> headings_;
  std::size_t judged_ = 0;                ///< of headings_, from the first
  std::size_t repeated_ = 0;              ///< since when the source repeats the same yaw
  std::optional<std::size_t> last_kept_;  ///< the latest that is neither thinned nor frozen
  std::optional<MapYaw> yaw_;
  HeadingReport report_;
};

}  // namespace adit
