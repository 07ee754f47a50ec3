// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// GnssConstraints, where there are headings: the map's place by them, and they against the fixes.
#include <algorithm>
#include <utility>

#include "adit/slam/core/median.hpp"
#include "adit/slam/gnss/gnss_constraints.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/gnss/heading_consensus.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

/// Of each coordinate: right where more than half of the places are.
Vector3d middle_of(const std::vector<Vector3d>& places) {
  Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vector3d& place : places) {
      values.push_back(place(axis));
    }
    middle(axis) = median(std::move(values));
  }
  return middle;
}

}  // namespace

// Fixes and, where the map's place is not known, headings that are not judged yet.
bool GnssConstraints::has_news(NodeId keyframe) const {
  const bool fixes = judged_ < fixes_.size() && fixes_[judged_].keyframe <= keyframe;
  return fixes || (!frame_ && judged_ > 0 && headings_.has_new(keyframe));
}

// By the place that fixes alone give. Where that contradicts the headings, a place that came by
// these is given up.
void GnssConstraints::assess_headings(PoseGraph& graph) {
  if (!headings_.any()) {
    return;
  }
  const std::vector<std::size_t> part = told_by(graph);
  const Eigen::Matrix3d level = levelling(graph);
  std::optional<MapYaw> by_fixes;
  std::optional<WorldFrame> frame = frame_;
  PlacedMap place{.T_world_map = graph.T_world_map()};
  if (part.size() >= kFewestFixes) {
    const WorldFrame middle = middle_frame(part);
    const std::optional<WorldFit> found = fit(graph, part, middle, false);
    if (found && 2 * found->agreeing >= part.size()) {
      const Eigen::Matrix3d& R = found->T_world_map.linear();
      by_fixes = {.yaw = std::atan2(R(1, 0), R(0, 0)), .sigma = found->yaw_sigma};
      frame = middle;
      place.T_world_map = found->T_world_map;
      place.T_world_map.linear() *= level;
    }
  }
  place.frame = frame ? &*frame : nullptr;
  headings_.assess(graph, level, place, by_fixes);
  if (placed_by_headings_ && !headings_.yaw()) {
    forget_place(graph);
  }
}

// With the yaw that headings give, any fix gives the rest: the most are taken that agree on it.
bool GnssConstraints::place_by_headings(PoseGraph& graph) {
  const std::vector<std::size_t> part = told_by(graph);
  const std::optional<MapYaw>& yaw = headings_.yaw();
  if (!yaw || part.empty()) {
    return false;
  }
  const WorldFrame frame = middle_frame(part);
  const std::vector<PositionPair> pairs = pairs_of(graph, part, frame, false);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw->yaw, Vector3d::UnitZ()).toRotationMatrix();
  std::vector<Vector3d> places;
  std::vector<Vector3d> points;
  for (const PositionPair& pair : pairs) {
    places.emplace_back(pair.p_world - R * pair.p_map);
    points.push_back(pair.p_map);
  }
  const Vector3d middle = middle_of(places);
  const Vector3d at = middle_of(points);
  std::vector<std::size_t> agreeing;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Vector3d weighted = Vector3d::Zero();
  for (std::size_t k = 0; k < part.size(); ++k) {
    const double turned = (pairs[k].p_map - at).head<2>().norm() * std::hypot(yaw->sigma, kMapYaw);
    const Eigen::Matrix3d covariance =
        pairs[k].covariance +
        (turned * turned + kShapeNoise * kShapeNoise) * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d weight = fix_information(covariance, true);
    const Vector3d apart = places[k] - middle;
    const bool agrees = apart.dot(fix_information(covariance, config_.height) * apart) < kFixGate;
    set_verdict(part[k], agrees ? FixVerdict::used : FixVerdict::outlier);
    if (agrees) {
      agreeing.push_back(part[k]);
      information += weight;
      weighted += weight * places[k];
    }
  }
  if (2 * agreeing.size() < part.size() || agreeing.empty()) {
    for (const std::size_t i : part) {
      set_verdict(i, FixVerdict::waiting);
    }
    return false;
  }
  // The frame lies about the first of them from now on; its axes differ by the convergence alone.
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();
  T_world_map.linear() = R * levelling(graph);
  T_world_map.translation() = information.ldlt().solve(weighted);
  frame_.emplace(fixes_[agreeing.front()].place);
  T_world_map.translation() += frame_->position_of(frame.origin());
  graph.set_T_world_map(orthonormalized(T_world_map));
  placed_by_headings_ = true;
  report_.yaw_sigma = yaw->sigma;
  headings_.set_placed();
  return true;
}

// The place whenever a tenth more fixes are there, or a tenth more headings, with which a single
// fix may do.
bool GnssConstraints::look_for_place(PoseGraph& graph) {
  const bool more_fixes = judged_ > tried_ + tried_ / 10;
  const auto grown = [](std::size_t now, std::size_t then) { return now > then + then / 10; };
  const bool assess =
      headings_.any() &&
      (grown(judged_, assessed_) || (!frame_ && grown(headings_.judged(), assessed_headings_)));
  if (assess) {
    assess_headings(graph);
    assessed_ = judged_;
    assessed_headings_ = headings_.judged();
  }
  if (frame_ && !placed_by_headings_) {
    return false;
  }
  return (more_fixes && find_place(graph, {})) || (assess && !frame_ && place_by_headings(graph));
}

}  // namespace adit
