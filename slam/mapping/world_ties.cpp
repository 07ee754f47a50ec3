// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/world_ties.hpp"

#include <algorithm>
#include <cmath>

#include "adit/slam/core/units.hpp"
#include "adit/slam/mapping/gnss_noise.hpp"
#include "adit/slam/mapping/graph_residuals.hpp"
#include "adit/slam/mapping/loop_optimization.hpp"

namespace adit {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLeastTime = 0.5;  // s, between fixes that count, unless they are
constexpr double kLeastWay = 1.0;   // m apart
constexpr double kMoved = 0.5;      // m, while which a receiver does not repeat itself
constexpr double kYawKnown = 1.0 * kDegree;
constexpr double kLeastAgreement = 0.5;  // of the fixes that have been seen by then
constexpr std::size_t kFewestFixes = 5;
constexpr double kLeastExtent = 10.0;      // m, of the fixes that agree
constexpr std::size_t kManyOutliers = 20;  // more than are used: the place is wrong
constexpr double kFixGate = 11.34;         // chi squared of three directions, 99 %
constexpr double kDrift = 0.01;      // of the way since the last fix that the map was fitted to
constexpr double kShapeNoise = 0.1;  // m, of the map's own shape
constexpr std::size_t kNodesBetween = 20;  // optimisations, at the least
constexpr int kMostRounds = 4;

bool is_possible(const MapFix& fix) {
  const Geodetic& place = fix.place;
  return std::isfinite(place.altitude) && std::abs(place.latitude) < 84.0 &&
         std::abs(place.longitude) <= 180.0 && std::abs(place.altitude) < 20e3 &&
         !(place.latitude == 0.0 && place.longitude == 0.0);
}

bool takes_part(FixVerdict verdict) {
  return verdict == FixVerdict::waiting || verdict == FixVerdict::used ||
         verdict == FixVerdict::outlier || verdict == FixVerdict::apart;
}

Vector3d p_map(const PoseGraph& graph, const MapFix& fix) {
  return graph.nodes()[graph.index_of(fix.keyframe)].T_map_node * fix.p_keyframe_antenna;
}

/// Turns the map so that its levelled nodes are level, by their mean.
Matrix3d levelling(const PoseGraph& graph) {
  Vector3d up = Vector3d::Zero();
  for (const LevelledNode& level : graph.levels()) {
    const PoseNode& node = graph.nodes()[graph.index_of(level.node)];
    up += level.information * node.T_map_node.linear().col(2);
  }
  return up.norm() > 0.0
             ? Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ()).toRotationMatrix()
             : Matrix3d::Identity();
}

/// The first part of the map is the one that lies in the world.
class FirstPart {
 public:
  explicit FirstPart(const PoseGraph& graph)
      : graph_(&graph), component_of_(connected_components(graph).component_of) {}
  bool has(NodeId node) const { return component_of_[graph_->index_of(node)] == 0; }

 private:
  const PoseGraph* graph_;
  std::vector<std::size_t> component_of_;
};

/// Of T_world_map, with the map's own shape taken as known.
Matrix6d covariance_of_world(const PoseGraph& graph) {
  Matrix6d information = 1e-8 * Matrix6d::Identity();
  const auto add = [&](const auto& tie) { information += tie.by_world.transpose() * tie.by_world; };
  const auto pose = [&](NodeId node) { return graph.nodes()[graph.index_of(node)].T_map_node; };
  for (const PositionFix& fix : graph.fixes()) {
    add(FixResidual(fix).linearized(graph.T_world_map(), pose(fix.node)));
  }
  for (const LevelledNode& level : graph.levels()) {
    add(LevelResidual(level).linearized(graph.T_world_map(), pose(level.node)));
  }
  return symmetric_inverse(information);
}

}  // namespace

void WorldTies::add(std::span<const MapFix> fixes) {
  fixes_.insert(fixes_.end(), fixes.begin(), fixes.end());
}

// The last digits of a receiver's position change even at rest.
bool WorldTies::is_repeated(std::size_t i) const {
  for (std::size_t before = i; before-- > 0;) {
    const MapFix& earlier = fixes_[before];
    if (earlier.place.latitude != fixes_[i].place.latitude ||
        earlier.place.longitude != fixes_[i].place.longitude) {
      return false;
    }
    if (fixes_[i].path - earlier.path > kMoved) {
      return true;
    }
  }
  return false;
}

bool WorldTies::is_near_the_last(std::size_t i) const {
  return last_kept_ && seconds(fixes_[i].stamp - fixes_[*last_kept_].stamp) < kLeastTime &&
         fixes_[i].path - fixes_[*last_kept_].path < kLeastWay;
}

// Its squared distance from where the map has it, in its own standard deviations and those of a map
// that may have drifted by so many metres.
double WorldTies::distance2(const PoseGraph& graph, const MapFix& fix, double drift) const {
  const Vector3d apart = graph.T_world_map() * p_map(graph, fix) - frame_->position_of(fix.place);
  const double variance = drift * drift + kShapeNoise * kShapeNoise;
  if (!config_.height) {
    const Eigen::Matrix2d covariance =
        fix.covariance.topLeftCorner<2, 2>() + variance * Eigen::Matrix2d::Identity();
    return apart.head<2>().dot(covariance.ldlt().solve(apart.head<2>()));
  }
  const Matrix3d covariance = fix.covariance + variance * Matrix3d::Identity();
  return apart.dot(covariance.ldlt().solve(apart));
}

void WorldTies::judge_new(const PoseGraph& graph) {
  for (; judged_ < fixes_.size() && graph.contains(fixes_[judged_].keyframe); ++judged_) {
    MapFix& fix = fixes_[judged_];
    if (!is_possible(fix)) {
      fix.verdict = FixVerdict::impossible;
    } else if (is_repeated(judged_)) {
      fix.verdict = FixVerdict::frozen;
    } else if (is_near_the_last(judged_)) {
      fix.verdict = FixVerdict::thinned;
    } else {
      last_kept_ = judged_;
      if (frame_) {
        fix.chi2 = distance2(graph, fix, kDrift * (fix.path - optimized_path_));
        fix.verdict = fix.chi2 < kFixGate ? FixVerdict::used : FixVerdict::outlier;
        used_since_ += fix.verdict == FixVerdict::used ? 1 : 0;
      }
    }
  }
}

std::optional<WorldFit> WorldTies::fit(const PoseGraph& graph, const WorldFrame& frame,
                                       bool swapped) const {
  const Matrix3d level = levelling(graph);
  std::vector<PositionPair> pairs;
  for (std::size_t i = 0; i < judged_; ++i) {
    const MapFix& fix = fixes_[i];
    if (takes_part(fix.verdict) && fix.verdict != FixVerdict::apart) {
      Geodetic place = fix.place;
      if (swapped) {
        std::swap(place.latitude, place.longitude);
      }
      pairs.push_back({.p_map = level * p_map(graph, fix),
                       .p_world = frame.position_of(place),
                       .covariance = fix.covariance,
                       .time = seconds(fix.stamp - fixes_.front().stamp)});
    }
  }
  return fit_world(pairs, config_.correlation);
}

// From all fixes so far; false: they do not tell it yet, or no better than it is known.
bool WorldTies::find_place(PoseGraph& graph) {
  std::vector<std::size_t> part;
  const FirstPart first(graph);
  for (std::size_t i = 0; i < judged_; ++i) {
    MapFix& fix = fixes_[i];
    if (takes_part(fix.verdict)) {
      if (!first.has(fix.keyframe)) {
        fix.verdict = FixVerdict::apart;
      } else {
        fix.verdict = fix.verdict == FixVerdict::apart ? FixVerdict::waiting : fix.verdict;
        part.push_back(i);
      }
    }
  }
  std::erase_if(part, [&](std::size_t i) { return fixes_[i].verdict == FixVerdict::apart; });
  if (part.size() < kFewestFixes) {
    return false;
  }
  // About one of the middle: the first may lie anywhere.
  std::vector<double> latitudes;
  for (const std::size_t i : part) {
    latitudes.push_back(fixes_[i].place.latitude);
  }
  const auto middle = latitudes.begin() + static_cast<std::ptrdiff_t>(latitudes.size() / 2);
  std::ranges::nth_element(latitudes, middle);
  const std::size_t central = *std::ranges::find_if(
      part, [&](std::size_t i) { return fixes_[i].place.latitude == *middle; });
  const std::optional<WorldFit> found = fit(graph, WorldFrame(fixes_[central].place), false);
  if (!found) {
    return false;
  }
  report_.yaw_sigma = found->yaw_sigma;
  const auto used =
      static_cast<std::size_t>(std::ranges::count(fixes_, FixVerdict::used, &MapFix::verdict));
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (found->agrees[i]) {
      box.extend(p_map(graph, fixes_[part[i]]).head<2>());
    }
  }
  const bool known =
      found->yaw_sigma < kYawKnown && found->agreeing >= kFewestFixes &&
      box.sizes().norm() >= kLeastExtent &&
      static_cast<double>(found->agreeing) >= kLeastAgreement * static_cast<double>(part.size());
  if (!known || (frame_ && 2 * found->agreeing < 3 * used)) {
    return false;
  }
  std::size_t at = 0;
  frame_.reset();
  for (const std::size_t i : part) {
    const bool agrees = found->agrees[at++];
    fixes_[i].verdict = agrees ? FixVerdict::used : FixVerdict::outlier;
    if (agrees && !frame_) {
      frame_.emplace(fixes_[i].place);
    }
  }
  const std::optional<WorldFit> again = fit(graph, *frame_, false);
  Eigen::Isometry3d T_world_map = (again ? *again : *found).T_world_map;
  T_world_map.linear() *= levelling(graph);
  graph.set_T_world_map(orthonormalized(T_world_map));
  return true;
}

// Of a short way a wrong place may fit, too.
bool WorldTies::is_contradicted() const {
  const auto used = std::ranges::count(fixes_, FixVerdict::used, &MapFix::verdict);
  const auto outliers = std::ranges::count(fixes_, FixVerdict::outlier, &MapFix::verdict);
  return frame_ && outliers > used && static_cast<std::size_t>(outliers) >= kManyOutliers;
}

void WorldTies::forget_place(PoseGraph& graph) {
  frame_.reset();
  report_.georeference.reset();
  graph.clear_fixes();
  used_since_ = 0;
  for (MapFix& fix : fixes_) {
    fix.verdict = takes_part(fix.verdict) ? FixVerdict::waiting : fix.verdict;
    fix.information.setZero();
    fix.chi2 = 0.0;
  }
}

void WorldTies::tie(PoseGraph& graph) {
  graph.clear_fixes();
  const FirstPart first(graph);
  std::vector<MapFix*> used;
  std::vector<double> times;
  for (MapFix& fix : fixes_) {
    fix.information.setZero();
    if (fix.verdict == FixVerdict::used && first.has(fix.keyframe)) {
      used.push_back(&fix);
      times.push_back(seconds(fix.stamp - fixes_.front().stamp));
    }
  }
  const std::vector<double> shares = independent_shares(times, config_.correlation);
  for (std::size_t i = 0; i < used.size(); ++i) {
    Matrix3d information = Matrix3d::Zero();
    if (config_.height) {
      information = used[i]->covariance.inverse();
    } else {
      information.topLeftCorner<2, 2>() = used[i]->covariance.topLeftCorner<2, 2>().inverse();
    }
    used[i]->information = 0.5 * shares[i] * (information + information.transpose());
    graph.add_fix(as_measured(*used[i], *frame_));
  }
}

void WorldTies::optimize(PoseGraph& graph) {
  tie(graph);
  const LoopOptimum optimum = optimize_with_loops(graph);
  ++report_.optimizations;
  if (optimum.report.termination != Termination::failed) {
    graph.set_poses(optimum.poses);
    graph.set_T_world_map(optimum.T_world_map);
  }
  for (const MapFix& fix : fixes_) {
    optimized_path_ = fix.verdict == FixVerdict::used ? fix.path : optimized_path_;
  }
  optimized_nodes_ = graph.nodes().size();
  used_since_ = 0;
}

// After an optimisation, when the map is where the fixes want it.
void WorldTies::judge_again(const PoseGraph& graph, double widest) {
  const FirstPart first(graph);
  for (std::size_t i = 0; i < judged_; ++i) {
    MapFix& fix = fixes_[i];
    if (!takes_part(fix.verdict)) {
      continue;
    }
    if (!first.has(fix.keyframe)) {
      fix.verdict = FixVerdict::apart;
      continue;
    }
    fix.chi2 = distance2(graph, fix, 0.0);
    const double gate = fix.verdict == FixVerdict::used ? widest : kFixGate;
    fix.verdict = fix.chi2 < gate ? FixVerdict::used : FixVerdict::outlier;
  }
}

void WorldTies::fill(Change& change, const PoseGraph& graph, const std::vector<MapFix>& before) {
  for (std::size_t i = 0; i < fixes_.size(); ++i) {
    if (fixes_[i].verdict != before[i].verdict || fixes_[i].chi2 != before[i].chi2 ||
        fixes_[i].information != before[i].information) {
      change.fixes.push_back(fixes_[i]);
    }
  }
  report_.fixes = fixes_.size();
  report_.verdicts = {};
  double used = 0.0;
  Vector3d squared = Vector3d::Zero();
  Eigen::AlignedBox2d box;
  for (const MapFix& fix : fixes_) {
    ++report_.verdicts[static_cast<std::size_t>(fix.verdict)];
    if (graph.contains(fix.keyframe)) {
      box.extend(p_map(graph, fix).head<2>());
    }
    if (fix.verdict == FixVerdict::used && graph.contains(fix.keyframe)) {
      used += 1.0;
      squared +=
          (graph.T_world_map() * p_map(graph, fix) - frame_->position_of(fix.place)).cwiseAbs2();
    }
  }
  report_.extent = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  report_.horizontal = used > 0.0 ? std::sqrt((squared.x() + squared.y()) / used) : 0.0;
  report_.vertical = used > 0.0 ? std::sqrt(squared.z() / used) : 0.0;
  if (frame_) {
    report_.georeference = Georeference{.origin = frame_->origin(),
                                        .T_world_map = graph.T_world_map(),
                                        .covariance = covariance_of_world(graph)};
    change.georeference = report_.georeference;
  }
}

WorldTies::Change WorldTies::take_effect(PoseGraph& graph, NodeId keyframe) {
  Change change;
  if (judged_ == fixes_.size() || fixes_[judged_].keyframe > keyframe) {
    return change;
  }
  const std::vector<MapFix> before = fixes_;
  const bool had_place = frame_.has_value();
  const std::size_t nodes = graph.nodes().size();
  judge_new(graph);
  if (is_contradicted()) {
    forget_place(graph);
  }
  bool wanted = false;
  if (!frame_) {
    wanted = find_place(graph);
  } else {
    wanted = used_since_ > 0 &&
             nodes >= optimized_nodes_ + std::max(kNodesBetween, optimized_nodes_ / 10);
  }
  if (wanted) {
    optimize(graph);
    judge_again(graph, 1.5 * kFixGate);
    change.moved = true;
  }
  change.place_is_lost = had_place && !frame_;
  fill(change, graph, before);
  return change;
}

WorldTies::Change WorldTies::finish(PoseGraph& graph) {
  Change change;
  if (fixes_.empty()) {
    return change;
  }
  const std::vector<MapFix> before = fixes_;
  const bool had_place = frame_.has_value();
  judge_new(graph);
  if (is_contradicted()) {
    forget_place(graph);
  }
  find_place(graph);
  for (int round = 0; frame_ && round < kMostRounds; ++round) {
    optimize(graph);
    change.moved = true;
    const std::vector<MapFix> judged = fixes_;
    judge_again(graph, kFixGate);
    if (std::ranges::equal(judged, fixes_, {}, &MapFix::verdict, &MapFix::verdict)) {
      break;
    }
  }
  if (is_contradicted()) {
    forget_place(graph);
    optimize(graph);
  }
  if (!frame_ && judged_ > 0) {
    // Not where exchanging them makes no place on the Earth.
    const bool possible = std::ranges::all_of(fixes_, [](const MapFix& fix) {
      return !is_possible(fix) || std::abs(fix.place.longitude) < 84.0;
    });
    const auto first = std::ranges::find_if(fixes_, is_possible);
    if (possible && first != fixes_.end()) {
      const WorldFrame frame({.latitude = first->place.longitude,
                              .longitude = first->place.latitude,
                              .altitude = first->place.altitude});
      const auto exchanged = fit(graph, frame, true);
      report_.swapped =
          exchanged && exchanged->yaw_sigma < kYawKnown && 10 * exchanged->agreeing > 8 * judged_;
    }
  }
  change.place_is_lost = had_place && !frame_;
  fill(change, graph, before);
  return change;
}

}  // namespace adit
