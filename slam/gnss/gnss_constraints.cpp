// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/gnss_constraints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adit/slam/gnss/first_part.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/gnss/heading_consensus.hpp"
#include "adit/slam/gnss/world_covariance.hpp"
#include "adit/slam/graph/graph_residuals.hpp"
#include "adit/slam/graph/loop_optimization.hpp"

namespace adit {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLeastTime = 0.5;         // s, between fixes that count, unless they are
constexpr double kLeastWay = 1.0;          // m apart
constexpr double kMoved = 0.5;             // m, while which a receiver does not repeat itself
constexpr double kLeastExtent = 10.0;      // m, of the fixes that agree
constexpr std::size_t kManyOutliers = 20;  // more than are used: the place is wrong
constexpr std::size_t kManyUsed = 10;      // for each outlier: no reason to look for a jump
constexpr double kDrift = 0.01;  // of the way since the last fix that the map was fitted to
constexpr std::size_t kNodesBetween = 20;  // optimisations, at the least
constexpr int kMostRounds = 4;
constexpr double kSlack = 1.5;  // of the gate, for what was used before, while more is to come

bool is_possible(const MapFix& fix) {
  const Geodetic& place = fix.place;
  return std::isfinite(place.altitude) && std::abs(place.latitude) < kMostLatitude &&
         std::abs(place.longitude) <= 180.0 && std::abs(place.altitude) < kMostAltitude &&
         !(place.latitude == 0.0 && place.longitude == 0.0);
}

bool takes_part(FixVerdict verdict) {
  return verdict == FixVerdict::waiting || verdict == FixVerdict::used ||
         verdict == FixVerdict::outlier || verdict == FixVerdict::apart;
}

Vector3d p_map(const PoseGraph& graph, const MapFix& fix) {
  return graph.nodes()[graph.index_of(fix.keyframe)].T_map_node * fix.p_keyframe_antenna;
}

}  // namespace

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

void GnssConstraints::begin_behind(std::vector<MapFix> fixes, std::vector<MapHeading> headings,
                                   const std::optional<Georeference>& georeference) {
  const bool has_headings = !headings.empty();
  headings_.begin_behind(std::move(headings));
  fixes_ = std::move(fixes);
  earlier_ = judged_ = tried_ = report_.fixes = fixes_.size();
  for (std::size_t i = 0; i < fixes_.size(); ++i) {
    const FixVerdict verdict = fixes_[i].verdict;
    ++report_.verdicts[static_cast<std::size_t>(verdict)];
    last_kept_ = takes_part(verdict) ? i : last_kept_;
    optimized_path_ = verdict == FixVerdict::used ? fixes_[i].path : optimized_path_;
  }
  if (georeference) {
    frame_.emplace(georeference->origin);
    placed_by_headings_ = has_headings && count(FixVerdict::used) < kFewestFixes;
  }
}

void GnssConstraints::add(std::span<const MapFix> fixes) {
  fixes_.insert(fixes_.end(), fixes.begin(), fixes.end());
  report_.fixes = fixes_.size();
  report_.verdicts[static_cast<std::size_t>(FixVerdict::waiting)] += fixes.size();
}

void GnssConstraints::set_verdict(std::size_t i, FixVerdict verdict) {
  if (fixes_[i].verdict != verdict) {
    --report_.verdicts[static_cast<std::size_t>(fixes_[i].verdict)];
    ++report_.verdicts[static_cast<std::size_t>(verdict)];
    fixes_[i].verdict = verdict;
    changed_.insert(i);
  }
}

void GnssConstraints::set_chi2(std::size_t i, double chi2) {
  if (fixes_[i].chi2 != chi2) {
    fixes_[i].chi2 = chi2;
    changed_.insert(i);
  }
}

std::size_t GnssConstraints::count(FixVerdict verdict) const {
  return report_.verdicts[static_cast<std::size_t>(verdict)];
}

// The last digits of a receiver's position change even at rest.
bool GnssConstraints::is_repeated(std::size_t i) const {
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

bool GnssConstraints::is_near_the_last(std::size_t i) const {
  return last_kept_ && seconds(fixes_[i].stamp - fixes_[*last_kept_].stamp) < kLeastTime &&
         fixes_[i].path - fixes_[*last_kept_].path < kLeastWay;
}

// Its squared distance from where the map has it, in its own standard deviations and those of a map
// that may have drifted by so many metres.
double GnssConstraints::distance2(const PoseGraph& graph, const MapFix& fix, double drift) const {
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

// Those of nodes up to `last`. What is tied to the world by nothing else cannot be judged by it.
void GnssConstraints::judge_new(const PoseGraph& graph, NodeId last) {
  const FirstPart first(graph);
  for (; judged_ < fixes_.size() && fixes_[judged_].keyframe <= last; ++judged_) {
    const MapFix& fix = fixes_[judged_];
    if (!is_possible(fix)) {
      set_verdict(judged_, FixVerdict::impossible);
    } else if (is_repeated(judged_)) {
      set_verdict(judged_, FixVerdict::frozen);
    } else if (is_near_the_last(judged_)) {
      set_verdict(judged_, FixVerdict::thinned);
    } else if (frame_ && !first.has(fix.keyframe)) {
      last_kept_ = judged_;
      set_verdict(judged_, FixVerdict::apart);
    } else {
      last_kept_ = judged_;
      if (frame_) {
        set_chi2(judged_, distance2(graph, fix, kDrift * (fix.path - optimized_path_)));
        set_verdict(judged_, fix.chi2 < kFixGate ? FixVerdict::used : FixVerdict::outlier);
        used_since_ += fix.verdict == FixVerdict::used ? 1 : 0;
      }
    }
  }
}

// Those that the place is told by: of the first part of the map, in order. The others are apart.
std::vector<std::size_t> GnssConstraints::told_by(const PoseGraph& graph) {
  std::vector<std::size_t> part;
  const FirstPart first(graph);
  for (std::size_t i = 0; i < judged_; ++i) {
    if (!takes_part(fixes_[i].verdict)) {
      continue;
    }
    if (!first.has(fixes_[i].keyframe)) {
      set_verdict(i, FixVerdict::apart);
      continue;
    }
    if (fixes_[i].verdict == FixVerdict::apart) {
      set_verdict(i, FixVerdict::waiting);
    }
    part.push_back(i);
  }
  return part;
}

std::vector<PositionPair> GnssConstraints::pairs_of(const PoseGraph& graph,
                                                    std::span<const std::size_t> part,
                                                    const WorldFrame& frame, bool swapped) const {
  const Matrix3d level = levelling(graph);
  std::vector<PositionPair> pairs;
  for (const std::size_t i : part) {
    const MapFix& fix = fixes_[i];
    Geodetic place = fix.place;
    if (swapped) {
      std::swap(place.latitude, place.longitude);
    }
    pairs.push_back({.p_map = level * p_map(graph, fix),
                     .p_world = frame.position_of(place),
                     .covariance = fix.covariance,
                     .time = seconds(fix.stamp - fixes_.front().stamp)});
  }
  return pairs;
}

std::optional<WorldFit> GnssConstraints::fit(const PoseGraph& graph,
                                             std::span<const std::size_t> part,
                                             const WorldFrame& frame, bool swapped) const {
  return fit_world(pairs_of(graph, part, frame, swapped), config_.correlation);
}

/// About one of the middle: the first may lie anywhere.
WorldFrame GnssConstraints::middle_frame(std::vector<std::size_t> part) const {
  const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
  std::ranges::nth_element(part, middle, {},
                           [&](std::size_t i) { return std::pair(fixes_[i].place.latitude, i); });
  return WorldFrame(fixes_[*middle].place);
}

// From all fixes so far; false: they do not tell it yet, or no better than it is known.
bool GnssConstraints::find_place(PoseGraph& graph, const PlaceNeeds& needs) {
  const std::vector<std::size_t> part = told_by(graph);
  tried_ = judged_;
  if (part.size() < kFewestFixes) {
    return false;
  }
  const std::optional<WorldFit> found = fit(graph, part, middle_frame(part), false);
  if (!found) {
    return false;
  }
  report_.yaw_sigma = found->yaw_sigma;
  std::vector<std::size_t> agreeing;
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (found->agrees[i]) {
      agreeing.push_back(part[i]);
      box.extend(p_map(graph, fixes_[part[i]]).head<2>());
    }
  }
  const bool known =
      found->yaw_sigma < needs.yaw_sigma && agreeing.size() >= kFewestFixes &&
      box.sizes().norm() >= kLeastExtent &&
      static_cast<double>(agreeing.size()) >= needs.agreement * static_cast<double>(part.size());
  const bool better =
      !frame_ || placed_by_headings_ || 2 * agreeing.size() >= 3 * count(FixVerdict::used);
  if (!known || !better) {
    return false;
  }
  for (std::size_t i = 0; i < part.size(); ++i) {
    set_verdict(part[i], found->agrees[i] ? FixVerdict::used : FixVerdict::outlier);
  }
  frame_.emplace(fixes_[agreeing.front()].place);
  const std::optional<WorldFit> again = fit(graph, part, *frame_, false);
  Eigen::Isometry3d T_world_map = (again ? *again : *found).T_world_map;
  T_world_map.linear() *= levelling(graph);
  if (std::exchange(placed_by_headings_, false)) {
    const double turn =
        rotation_angle(T_world_map.linear() * graph.T_world_map().linear().transpose());
    const double sigma = std::hypot(found->yaw_sigma, config_.heading_offset, kMapYaw);
    if (turn * turn > kHeadingGate * sigma * sigma) {
      headings_.forget_place();  // the fixes contradict them
    }
  }
  graph.set_T_world_map(orthonormalized(T_world_map));
  return true;
}

// Of a short way a wrong place may fit, too.
bool GnssConstraints::is_contradicted() const {
  const std::size_t outliers = count(FixVerdict::outlier);
  return frame_ && outliers > count(FixVerdict::used) && outliers >= kManyOutliers;
}

void GnssConstraints::forget_place(PoseGraph& graph) {
  frame_.reset();
  placed_by_headings_ = false;
  headings_.forget_place();
  graph.clear_fixes();
  used_since_ = 0;
  for (std::size_t i = 0; i < fixes_.size(); ++i) {
    if (takes_part(fixes_[i].verdict)) {
      set_verdict(i, FixVerdict::waiting);
    }
    set_chi2(i, 0.0);
    fixes_[i].information.setZero();
  }
}

void GnssConstraints::tie(PoseGraph& graph) {
  graph.clear_fixes();
  const FirstPart first(graph);
  std::vector<std::size_t> used;
  std::vector<double> times;
  for (std::size_t i = 0; i < fixes_.size(); ++i) {
    if (fixes_[i].verdict == FixVerdict::used && first.has(fixes_[i].keyframe)) {
      used.push_back(i);
      times.push_back(seconds(fixes_[i].stamp - fixes_.front().stamp));
    } else {
      fixes_[i].information.setZero();
    }
  }
  const std::vector<double> shares = independent_shares(times, config_.correlation);
  for (std::size_t i = 0; i < used.size(); ++i) {
    MapFix& fix = fixes_[used[i]];
    const Matrix3d information = shares[i] * fix_information(fix.covariance, config_.height);
    if (fix.information != information) {
      fix.information = information;
      changed_.insert(used[i]);
    }
    graph.add_fix(as_measured(fix, *frame_));
  }
  if (frame_) {
    for (const MapHeading& heading : headings_.used(graph)) {
      graph.add_heading(as_measured(heading, graph, *frame_));
    }
  }
}

void GnssConstraints::optimize(PoseGraph& graph) {
  tie(graph);
  const LoopOptimum optimum = optimize_with_loops(graph);
  ++report_.optimizations;
  odometry_scales_ = {.all = optimum.odometry_scale, .horizontal_drift = optimum.level_drift_scale};
  report_.level_drift_scale = optimum.level_drift_scale;
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

// After an optimisation, when the map is where the fixes want it. True where a verdict is another.
bool GnssConstraints::judge_again(const PoseGraph& graph, double gate_of_used) {
  bool changed = false;
  for (const std::size_t i : told_by(graph)) {
    const FixVerdict before = fixes_[i].verdict;
    set_chi2(i, distance2(graph, fixes_[i], 0.0));
    const double gate = before == FixVerdict::used ? gate_of_used : kFixGate;
    set_verdict(i, fixes_[i].chi2 < gate ? FixVerdict::used : FixVerdict::outlier);
    changed |= fixes_[i].verdict != before;
  }
  headings_.judge_again(graph, *frame_);
  return changed;
}

// Until no verdict changes.
void GnssConstraints::settle(PoseGraph& graph) {
  for (int round = 0; round < kMostRounds; ++round) {
    optimize(graph);
    if (!judge_again(graph, kFixGate)) {
      break;
    }
  }
}

/// What is left of the used fixes, and how far all lie apart.
void GnssConstraints::measure(const PoseGraph& graph) {
  Vector3d squared = Vector3d::Zero();
  std::size_t heights = 0;
  double chi2 = 0.0;
  Eigen::AlignedBox2d box;
  for (const MapFix& fix : fixes_) {
    const Vector3d p = p_map(graph, fix);
    box.extend(p.head<2>());
    if (fix.verdict == FixVerdict::used) {
      const Vector3d left = graph.T_world_map() * p - frame_->position_of(fix.place);
      squared.head<2>() += left.head<2>().cwiseAbs2();
      squared.z() += has_height(fix.covariance) ? left.z() * left.z() : 0.0;
      heights += has_height(fix.covariance) ? 1U : 0U;
      chi2 += fix.chi2;
    }
  }
  report_.extent = box.sizes().maxCoeff();
  const auto used = static_cast<double>(std::max<std::size_t>(1, count(FixVerdict::used)));
  report_.horizontal = std::sqrt(squared.head<2>().sum() / used);
  report_.vertical =
      std::sqrt(squared.z() / static_cast<double>(std::max<std::size_t>(1, heights)));
  report_.heights = heights;
  report_.innovation_squared = chi2 / (used * (config_.height ? 3.0 : 2.0));
}

// Not where exchanging them makes no place on the Earth.
bool GnssConstraints::would_agree_exchanged(const PoseGraph& graph) {
  const std::vector<std::size_t> part = told_by(graph);
  const bool possible = std::ranges::all_of(
      part, [&](std::size_t i) { return std::abs(fixes_[i].place.longitude) < kMostLatitude; });
  if (part.empty() || !possible) {
    return false;
  }
  const Geodetic& first = fixes_[part.front()].place;
  const WorldFrame frame(
      {.latitude = first.longitude, .longitude = first.latitude, .altitude = first.altitude});
  const std::optional<WorldFit> found = fit(graph, part, frame, true);
  return found && found->yaw_sigma < PlaceNeeds{}.yaw_sigma &&
         10 * found->agreeing > 8 * part.size();
}

// Where many fixes do not agree with the others.
void GnssConstraints::look_for_jump(const PoseGraph& graph) {
  const std::vector<std::size_t> part = told_by(graph);
  if (part.size() < kFewestFixes ||
      (frame_ && kManyUsed * count(FixVerdict::outlier) < count(FixVerdict::used))) {
    return;
  }
  const std::vector<PositionPair> pairs = pairs_of(graph, part, middle_frame(part), false);
  const std::optional<WorldFit> found = fit_world(pairs, config_.correlation);
  report_.asked = part.size();
  report_.agreeing = found ? found->agreeing : 0;
  report_.jump = found ? find_jump(pairs, *found) : std::nullopt;
}

GnssConstraints::Change GnssConstraints::take_change(const PoseGraph& graph, bool moved,
                                                     bool had_place) {
  Change change{.fixes = {}, .moved = moved};
  for (const std::size_t i : std::exchange(changed_, {})) {
    change.fixes.push_back(fixes_[i]);
  }
  change.place_is_lost = had_place && !frame_;
  if (frame_ && moved) {
    change.georeference = Georeference{.origin = frame_->origin(),
                                       .T_world_map = graph.T_world_map(),
                                       .covariance = covariance_of_world(graph)};
  }
  return change;
}

GnssConstraints::Change GnssConstraints::take_effect(PoseGraph& graph, NodeId keyframe,
                                                     bool may_optimize) {
  if (!may_optimize || !has_news(keyframe)) {
    return {};
  }
  const bool had_place = frame_.has_value();
  judge_new(graph, keyframe);
  headings_.judge_new(graph, keyframe);
  if (is_contradicted()) {
    forget_place(graph);
  }
  const bool found = look_for_place(graph);
  const std::size_t nodes = graph.nodes().size();
  const bool wanted =
      found || (frame_ && used_since_ > 0 &&
                nodes >= optimized_nodes_ + std::max(kNodesBetween, optimized_nodes_ / 10));
  if (wanted) {
    optimize(graph);
    judge_again(graph, kSlack * kFixGate);
  }
  return take_change(graph, wanted, had_place);
}

GnssConstraints::Change GnssConstraints::finish(PoseGraph& graph, bool may_optimize) {
  if (fixes_.empty()) {
    report_.heading = headings_.report();
    return {};
  }
  const bool had_place = frame_.has_value();
  judge_new(graph, fixes_.back().keyframe);
  headings_.judge_new(graph, std::numeric_limits<NodeId>::max());
  if (is_contradicted()) {
    forget_place(graph);
  }
  assess_headings(graph);
  if (!find_place(graph, {}) && !frame_) {
    place_by_headings(graph);
  }
  if (frame_ && may_optimize) {
    settle(graph);
  }
  if (is_contradicted()) {
    forget_place(graph);
    if (may_optimize) {
      optimize(graph);
    }
  }
  if (may_optimize && earlier_ == 0) {  // how the lidar of earlier sessions moved is not stored
    calibrate_antenna(graph);
  }
  report_.swapped = !frame_ && would_agree_exchanged(graph);
  look_for_jump(graph);
  measure(graph);
  Change change = take_change(graph, had_place || frame_, had_place);
  if (frame_) {
    change.headings = headings_.used(graph);
  } else if (had_place) {
    change.headings.emplace();
  }
  report_.georeference = change.georeference;
  if (!frame_) {
    headings_.forget_place();
  }
  report_.heading = headings_.report();
  return change;
}

}  // namespace adit
