// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// GnssConstraints, at the end: where the antenna really sits, and how late the receiver is.
#include <algorithm>
#include <utility>

#include "adit/slam/gnss/gnss_constraints.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/graph/graph_residuals.hpp"
#include "adit/slam/graph/horizontal_drift.hpp"
#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/graph/solver.hpp"

namespace adit {
namespace {

constexpr int kMostCorrections = 4;
constexpr double kCorrected = 0.25;  // standard deviations that a correction may leave
// By which the sum of chi squared has to fall, and by which part of it.
constexpr double kLeastGain = 6.0;
constexpr double kLeastGainShare = 0.1;
// With a wrong antenna or a late receiver no place may fit half of the fixes, or only parts of the
// way: a trial begins with less.
constexpr double kFewAgree = 0.05;
constexpr double kRoughYaw = 10.0 * kDegree;

/// Without its fixes, and with the odometry's covariances counted so many times.
PoseGraph without_fixes(const PoseGraph& graph, double odometry_scale) {
  PoseGraph scaled = graph.with_odometry_scaled(odometry_scale);
  scaled.clear_fixes();
  return scaled;
}

/// Which entries of an AntennaError are corrected.
using Corrected = Eigen::Array<bool, 4, 1>;

Corrected significant_ones(const std::array<AntennaParameter, 4>& parameters) {
  Corrected ones;
  std::ranges::transform(parameters, ones.begin(), &AntennaParameter::significant);
  return ones;
}

}  // namespace

// From fixes that are used and from outliers: with a wrong antenna right ones may be among these.
std::optional<AntennaEstimate> GnssConstraints::antenna_estimate(const PoseGraph& graph) {
  std::vector<AntennaSighting> sightings;
  for (const std::size_t i : told_by(graph)) {
    const MapFix& fix = fixes_[i];
    sightings.push_back({.node = fix.keyframe,
                         .T_node_lidar = fix.T_keyframe_lidar,
                         .twist = fix.twist,
                         .p_lidar_antenna = fix.T_keyframe_lidar.inverse() * fix.p_keyframe_antenna,
                         .p_world = frame_->position_of(fix.place),
                         .covariance = fix.covariance,
                         .time = seconds(fix.stamp - fixes_.front().stamp)});
  }
  return estimate_antenna(as_weighted(without_fixes(graph, odometry_scales_.all)), sightings,
                          {.correlation = config_.correlation, .height = config_.height});
}

// Fixes' places in their keyframes, with the lidar's way by the odometry.
void GnssConstraints::correct_antenna(const AntennaError& error) {
  for (std::size_t i = 0; i < fixes_.size(); ++i) {
    MapFix& fix = fixes_[i];
    const Eigen::Vector3d p_lidar_antenna =
        fix.T_keyframe_lidar.inverse() * fix.p_keyframe_antenna + error.head<3>();
    if (error(kDelay) != 0.0) {
      const Nanoseconds before = fix.stamp - nanoseconds(delay_);
      const Nanoseconds after = fix.stamp - nanoseconds(delay_ + error(kDelay));
      const auto way = track_.way(before, after);
      fix.T_keyframe_lidar =
          fix.T_keyframe_lidar * (way ? *way : se3_exp(-error(kDelay) * fix.twist));
      const std::optional<TrackedMotion> then = track_.at(after);
      fix.twist = then ? then->twist : fix.twist;
    }
    fix.p_keyframe_antenna = fix.T_keyframe_lidar * p_lidar_antenna;
    changed_.insert(i);
  }
  delay_ += error(kDelay);
}

void GnssConstraints::judge_by(const AntennaEstimate& estimate, const PoseGraph& graph) {
  const std::vector<std::size_t> part = told_by(graph);
  for (std::size_t i = 0; i < part.size(); ++i) {
    set_verdict(part[i], estimate.agrees[i] ? FixVerdict::used : FixVerdict::outlier);
  }
}

// Of edges, verticals and fixes where the graph is; outliers count as if they were at their gate.
double GnssConstraints::cost(const PoseGraph& graph, const OdometryScales& scales) {
  double sum =
      graph_cost(with_horizontal_drift(without_fixes(graph, scales.all), scales.horizontal_drift),
                 loop_kernels());
  const std::vector<std::size_t> part = told_by(graph);
  std::vector<double> times;
  for (const std::size_t i : part) {
    times.push_back(seconds(fixes_[i].stamp - fixes_.front().stamp));
  }
  const std::vector<double> shares = independent_shares(times, config_.correlation);
  for (std::size_t i = 0; i < part.size(); ++i) {
    const MapFix& fix = fixes_[part[i]];
    const Eigen::Isometry3d T_world_keyframe =
        graph.T_world_map() * graph.nodes()[graph.index_of(fix.keyframe)].T_map_node;
    const Eigen::Vector3d apart =
        T_world_keyframe * fix.p_keyframe_antenna - frame_->position_of(fix.place);
    const double chi2 = apart.dot(fix_information(fix.covariance, config_.height) * apart);
    const Eigen::Matrix3d with_shape =
        fix.covariance + kShapeNoise * kShapeNoise * Eigen::Matrix3d::Identity();
    const double gated = apart.dot(fix_information(with_shape, config_.height) * apart);
    sum += shares[i] * chi2 * std::min(1.0, kFixGate / std::max(gated, kFixGate));
  }
  return sum;
}

bool GnssConstraints::most_agree() const {
  return count(FixVerdict::used) >= count(FixVerdict::outlier) + count(FixVerdict::waiting);
}

// Round by round, each from where the graph is by then. None: the equations cannot be solved.
std::optional<AntennaEstimate> GnssConstraints::correct_significant(PoseGraph& graph,
                                                                    AntennaEstimate estimate) {
  AntennaError total = AntennaError::Zero();
  Corrected corrected = Corrected::Constant(false);
  for (int round = 0; round < kMostCorrections; ++round) {
    corrected = corrected || significant_ones(judged(estimate));
    const AntennaError step = corrected.select(estimate.error, AntennaError::Zero());
    const auto negligible = kCorrected * kCorrected * estimate.covariance.diagonal().array();
    if ((step.array().square() < negligible).all()) {
      break;
    }
    total += step;
    correct_antenna(step);
    judge_by(estimate, graph);
    settle(graph);
    const std::optional<AntennaEstimate> next = antenna_estimate(graph);
    if (!next) {
      return std::nullopt;
    }
    estimate = *next;
  }
  report_.antenna.p_lidar_antenna += total.head<3>();
  report_.antenna.time_offset -= total(kDelay);
  estimate.error = corrected.select(total, estimate.error);
  return estimate;
}

// Nothing is corrected that is not beyond doubt, and nothing that does not prove better.
void GnssConstraints::calibrate_antenna(PoseGraph& graph) {
  GnssConstraints trial = *this;
  PoseGraph moved = graph;
  if (!frame_) {
    if (!trial.find_place(moved, {.agreement = kFewAgree, .yaw_sigma = kRoughYaw})) {
      return;
    }
    trial.settle(moved);
  }
  const std::optional<AntennaEstimate> first = trial.antenna_estimate(moved);
  if (!first) {
    return;
  }
  AntennaReport& found = trial.report_.antenna;
  found = {.estimated = true,
           .parameters = judged(*first),
           .p_lidar_antenna =
               fixes_.front().T_keyframe_lidar.inverse() * fixes_.front().p_keyframe_antenna,
           .time_offset = config_.time_offset};
  AntennaReport left_alone = found;
  if (found.any_significant()) {
    const OdometryScales scales = trial.odometry_scales_;
    found.cost_before = trial.cost(moved, scales);
    const std::optional<AntennaEstimate> corrected = trial.correct_significant(moved, *first);
    bool known = corrected.has_value();
    if (known && !frame_) {  // as well as any place has to be
      trial.frame_.reset();
      known = trial.find_place(moved, {});
      if (known) {
        trial.settle(moved);
      }
    }
    if (known) {
      found.parameters = left_alone.parameters = judged(*corrected);
      found.cost_after = trial.cost(moved, scales);
      const double gain = found.cost_before - found.cost_after;
      found.corrected =
          trial.most_agree() && gain > std::max(kLeastGain, kLeastGainShare * found.cost_before);
    }
  }
  if (found.corrected) {
    *this = std::move(trial);
    graph = std::move(moved);
  } else if (frame_) {
    report_.antenna = left_alone;
  }
}

}  // namespace adit
