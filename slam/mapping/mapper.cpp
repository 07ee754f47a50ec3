// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/mapper.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/graph/graph_residuals.hpp"
#include "adit/slam/graph/horizontal_drift.hpp"
#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/registration/beam_spacing.hpp"
#include "adit/slam/submaps/submap_alignment.hpp"

namespace adit {
namespace {

/// LoopReport::residual_squared.
double residual_of_loops(const PoseGraph& graph) {
  const auto results = edge_results(graph, poses_of(graph), loop_kernels());
  double chi2 = 0.0;
  double loops = 0.0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (results[i] && graph.edges()[i].kind == EdgeKind::loop) {
      chi2 += results[i]->chi2;
      loops += 1.0;
    }
  }
  return chi2 / (6.0 * std::max(1.0, loops));
}

}  // namespace

Mapper::Mapper(engine::Context& context, const Config& config, MapStore& store, SessionId session,
               const MapMemory& memory, EarlierSessions earlier,
               const std::optional<StartPlace>& start)
    : context_(&context),
      config_(config),
      store_(&store),
      session_(session),
      beam_spacing_(config.preprocess.beam_spacing),
      builder_(context, config.preprocess, config.mapping.r_submap),
      clouds_(context, config.preprocess),
      aligner_(context, submap_alignment_settings(config, method_of(config.registration))),
      assembly_(context, config, store, memory, earlier),
      start_(start),
      next_(assembly_.start().keyframe),
      path_(assembly_.start().path),
      next_fix_(assembly_.start().fix) {}

MapPlacement Mapper::add(const Sweep& sweep, const SweepResult& result,
                         std::span<const Point> cloud) {
  if (beam_spacing_ == 0.0) {
    beam_spacing_ = measured_beam_spacing(sweep.points).value_or(0.0);
  }
  const bool restarted = result.state == OdometryState::restarted;
  if (start_) {
    assembly_.begin_at(expected_start(*std::exchange(start_, std::nullopt), result.T_map_lidar));
  }
  place_fixes(result);
  place_headings(result);
  const bool after_silence = result.silence > 0.0 && result.state == OdometryState::tracking;
  if (!open_ || result.keyframe || restarted || after_silence || builder_.full()) {
    if (open_) {
      freeze();
    }
    open_ = Open{.id = next_++,
                 .lidar = {result.stamp, result.T_map_lidar, result.uncertainty},
                 .detached = restarted,
                 .after_silence = after_silence};
  }
  const bool believed = result.state != OdometryState::coasting;
  builder_.add({.stamp = result.stamp,
                .T_odom_lidar = result.T_map_lidar,
                .cloud = believed ? cloud : std::span<const Point>(),
                .gravity_odom = result.inertial.gravity_map,
                .gravity_sigma = gravity_sigma(result.inertial)});
  last_sweep_ = result.stamp;
  path_ += last_pose_ && !restarted
               ? (result.T_map_lidar.translation() - last_pose_->pose.translation()).norm()
               : 0.0;
  last_pose_ = {.stamp = result.stamp, .pose = result.T_map_lidar};
  if (has_receiver_) {
    assembly_.world().add_pose(*last_pose_, restarted);
  }
  ++report_.sweeps;
  return {.keyframe = open_->id,
          .T_map_lidar = assembly_.T_map_odom() * result.T_map_lidar,
          .localization = assembly_.localization()};
}

void Mapper::add(const GnssFix& fix, const Eigen::Vector3d& p_lidar_antenna) {
  if (fix.kind == GnssFixKind::none) {
    assembly_.world().count_without_position();
    return;
  }
  has_receiver_ = true;
  const auto later = std::ranges::upper_bound(
      pending_, fix.stamp, {}, [](const PendingFix& pending) { return pending.fix.stamp; });
  pending_.insert(later, {.fix = fix, .p_lidar_antenna = p_lidar_antenna});
}

void Mapper::add(const Heading& heading, const Eigen::Vector3d& axis_lidar) {
  const auto later =
      std::ranges::upper_bound(pending_headings_, heading.stamp, {},
                               [](const PendingHeading& pending) { return pending.heading.stamp; });
  pending_headings_.insert(later, {.heading = heading, .axis_lidar = axis_lidar});
}

// What lies between the sweep before and this one, which the keyframe that is open has seen.
bool Mapper::is_placed_by(const SweepResult& next) const {
  return open_ && last_pose_ && next.state != OdometryState::restarted &&
         seconds(next.stamp - last_pose_->stamp) < kLongestInterpolation;
}

void Mapper::place_headings(const SweepResult& next) {
  const bool known = is_placed_by(next);
  for (; !pending_headings_.empty() && pending_headings_.front().heading.stamp < next.stamp;
       pending_headings_.pop_front()) {
    const auto& [heading, axis_lidar] = pending_headings_.front();
    if (!known || heading.stamp < last_pose_->stamp) {
      assembly_.world().count_headings_outside(1);
      continue;
    }
    const TrackedMotion lidar =
        between(*last_pose_, {.stamp = next.stamp, .pose = next.T_map_lidar}, heading.stamp);
    open_->headings.push_back({.keyframe = open_->id,
                               .stamp = heading.stamp,
                               .yaw = heading.yaw,
                               .sigma = heading_deviation(heading, config_.gnss),
                               .axis_keyframe = lidar.T_odom_lidar.linear() * axis_lidar});
  }
}

void Mapper::place_fixes(const SweepResult& next) {
  const bool known = is_placed_by(next);
  for (; !pending_.empty() && pending_.front().fix.stamp < next.stamp; pending_.pop_front()) {
    const auto& [fix, p_lidar_antenna] = pending_.front();
    if (!known || fix.stamp < last_pose_->stamp) {
      assembly_.world().count_outside(1);
      continue;
    }
    const TrackedMotion lidar =
        between(*last_pose_, {.stamp = next.stamp, .pose = next.T_map_lidar}, fix.stamp);
    const double part =
        seconds(fix.stamp - last_pose_->stamp) / seconds(next.stamp - last_pose_->stamp);
    const Eigen::Isometry3d T_last_next = last_pose_->pose.inverse() * next.T_map_lidar;
    open_->fixes.push_back({.id = next_fix_++,
                            .keyframe = open_->id,
                            .stamp = fix.stamp,
                            .kind = fix.kind,
                            .place = {fix.latitude, fix.longitude, fix.altitude},
                            .covariance = fix_covariance(fix, config_.gnss),
                            .p_keyframe_antenna = lidar.T_odom_lidar * p_lidar_antenna,
                            .path = path_ + part * T_last_next.translation().norm(),
                            .T_keyframe_lidar = lidar.T_odom_lidar,
                            .twist = lidar.twist});
  }
}

void Mapper::finish() {
  assembly_.world().count_outside(pending_.size());
  pending_.clear();
  assembly_.world().count_headings_outside(pending_headings_.size());
  pending_headings_.clear();
  store_->begin_end(last_sweep_);
  if (open_) {
    freeze();
  }
  assembly_.finish();
  report_.loops = assembly_.loops();
  if (report_.loops) {
    report_.loops->farthest_from_odometry = farthest_from_odometry(assembly_.graph());
    report_.loops->residual_squared = residual_of_loops(assembly_.graph());
  }
  report_.outgrown = assembly_.outgrown();
  report_.gnss = assembly_.world().report();
  report_.localization = assembly_.localization();
  report_.components = connected_components(assembly_.graph()).components.size();
  const PoseGraph& graph = assembly_.graph();
  const bool is_tied = !graph.fixes().empty() || !graph.headings().empty() ||
                       (report_.loops && report_.loops->accepted > 0);
  if (is_tied && !report_.outgrown) {
    report_.shares =
        map_shares(with_horizontal_drift(as_weighted(graph), report_.gnss.level_drift_scale));
  }
}

// Whatever fails on the way, it is open no more: its sweeps have left the builder.
void Mapper::freeze() {
  const auto start = std::chrono::steady_clock::now();
  Open open = *std::exchange(open_, std::nullopt);
  const FrozenSubmap frozen = builder_.freeze(beam_spacing_);
  const KeyframeSubmap& submap = frozen.submap;
  const SurfaceCloud cloud = make_surface_cloud(*context_, submap);
  for (MapFix& fix : open.fixes) {
    fix.p_keyframe_antenna = frozen.T_odom_keyframe.inverse() * fix.p_keyframe_antenna;
    fix.T_keyframe_lidar = frozen.T_odom_keyframe.inverse() * fix.T_keyframe_lidar;
  }
  for (MapHeading& heading : open.headings) {
    heading.axis_keyframe = frozen.T_odom_keyframe.linear().transpose() * heading.axis_keyframe;
  }
  std::optional<PoseEdge> edge;
  if (last_ && !open.detached) {
    edge = tie(*last_, open, frozen, cloud);
  }
  assembly_.add(
      {.keyframe = {.id = open.id,
                    .session = session_,
                    .stamp = submap.sweeps.front().stamp,
                    .covariance = in_keyframe_axes(open.lidar.uncertainty.in_map(),
                                                   submap.sweeps.front().T_keyframe_lidar)},
       .T_odom_keyframe = frozen.T_odom_keyframe,
       .submap = &submap,
       .cloud = &cloud,
       .edge = edge,
       .fixes = std::move(open.fixes),
       .headings = std::move(open.headings)});
  const bool has_points = cloud.size > 0;
  last_.emplace(Frozen{.id = open.id,
                       .lidar = open.lidar,
                       .T_odom_keyframe = frozen.T_odom_keyframe,
                       .target = has_points
                                     ? clouds_.make_target(cloud, aligner_.settings().method,
                                                           std::array{config_.registration.r_align})
                                     : AlignmentTarget(),
                       .has_points = has_points});
  ++report_.keyframes;
  report_.points += submap.points.size();
  report_.seen_through += submap.points.size() - cloud.size;
  report_.lost_points += frozen.lost_points;
  report_.crowded_cells += frozen.crowded_cells;
  report_.keyframe_ms.push_back(
      std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - start).count());
}

// What the odometry and an alignment of the two submaps say of the way between them.
PoseEdge Mapper::tie(const Frozen& from, const Open& to, const FrozenSubmap& submap,
                     const SurfaceCloud& cloud) {
  const KeyframeMotion odometry =
      odometry_motion(from.lidar, to.lidar, from.T_odom_keyframe.inverse() * submap.T_odom_keyframe,
                      submap.submap.sweeps.front().T_keyframe_lidar);
  ++report_.edges;
  // After a silence an alignment of the submaps would only repeat the odometry's.
  if (from.has_points && cloud.size > 0 && !to.after_silence) {
    const AlignmentPair pair{.source = &cloud,
                             .target = &from.target,
                             .T_target_source = odometry.T_from_to,
                             .prior_information = edge_of(from.id, to.id, odometry).information};
    const RegistrationResult aligned = aligner_.align(std::span(&pair, 1)).front();
    if (is_usable(aligned.status)) {
      ++report_.aligned_edges;
      assembly_.add_expected_rms(aligned.residual_rms);
      return edge_of(from.id, to.id, combined(odometry, motion_of(aligned)));
    }
  }
  return edge_of(from.id, to.id, odometry);
}

}  // namespace adit
