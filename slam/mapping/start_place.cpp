// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/start_place.hpp"

#include <algorithm>
#include <cmath>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

// How well somebody knows how two places lie to each other: one sigma.
constexpr double kGuessedPosition = 1.0;                   // m
constexpr double kGuessedAngle = 5.0 / kDegreesPerRadian;  // rad
constexpr double kGuessedHeight = 0.5;                     // m, of a start: a storey is six of them
constexpr double kUnmeasuredHeight = 3.0;                  // m, where fixes give none: a storey

double heading_of(const Eigen::Matrix3d& R) {
  return std::atan2(R(1, 0), R(0, 0));
}

Matrix6d symmetric(const Matrix6d& covariance) {
  return 0.5 * (covariance + covariance.transpose());
}

/// Of a pose T_map, as of T_map * T_map_keyframe.
Matrix6d moved_to(const Eigen::Isometry3d& T_map_keyframe, const Matrix6d& covariance) {
  const Matrix6d moved = adjoint(T_map_keyframe.inverse());
  return moved * covariance * moved.transpose();
}

/// The frame of one origin in that of another: both touch the Earth there, and north is not the
/// same in them.
Eigen::Isometry3d T_world_other(const WorldFrame& world, const WorldFrame& other) {
  const Eigen::Vector3d origin = world.position_of(other.origin());
  Eigen::Isometry3d T(Eigen::AngleAxisd(world.convergence_at(origin), Eigen::Vector3d::UnitZ()));
  T.translation() = origin;
  return T;
}

bool is_position(const MapFix& fix) {
  return std::isfinite(fix.place.latitude) && std::isfinite(fix.place.longitude) &&
         std::abs(fix.place.latitude) < kMostLatitude && fix.covariance.allFinite();
}

}  // namespace

Matrix6d covariance_of_guess() {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kGuessedPosition), Eigen::Vector3d::Constant(kGuessedAngle);
  return sigma.cwiseAbs2().asDiagonal();
}

PoseEdge start_edge(const PoseNode& map, const PoseNode& node, const Matrix6d& covariance) {
  return {.from = map.id,
          .to = node.id,
          .T_from_to = map.T_map_node.inverse() * node.T_map_node,
          .information = symmetric_inverse(covariance),
          .kind = EdgeKind::start};
}

ExpectedStart expected_start(const StartPlace& guess, const Eigen::Isometry3d& T_odom_lidar) {
  const Eigen::AngleAxisd turn(guess.heading - heading_of(T_odom_lidar.linear()),
                               Eigen::Vector3d::UnitZ());
  Eigen::Isometry3d T_map_odom(turn);
  T_map_odom.translation() = guess.position - turn * T_odom_lidar.translation();
  Matrix6d covariance = covariance_of_guess();
  covariance(2, 2) = kGuessedHeight * kGuessedHeight;
  return {.T_map_odom = T_map_odom, .covariance = covariance};
}

Georeference with_shared_error(Georeference georeference, std::span<const MapFix> fixes) {
  const auto used = std::ranges::find(fixes, FixVerdict::used, &MapFix::verdict);
  if (used != fixes.end()) {
    const Eigen::Matrix3d R_map_world = georeference.T_world_map.linear().transpose();
    georeference.covariance.topLeftCorner<3, 3>() +=
        R_map_world * used->covariance * R_map_world.transpose();
  }
  return georeference;
}

ExpectedStart expected_start(const Georeference& map, const Georeference& other,
                             const Eigen::Isometry3d& T_other_keyframe) {
  const Eigen::Isometry3d T_map_other =
      map.T_world_map.inverse() * T_world_other(WorldFrame(map.origin), WorldFrame(other.origin)) *
      other.T_world_map;
  return {.T_map_odom = T_map_other,
          .covariance = symmetric(covariance_of_guess() +
                                  moved_to(T_map_other * T_other_keyframe, map.covariance) +
                                  moved_to(T_other_keyframe, other.covariance))};
}

void StartByFixes::add(std::span<const MapFix> fixes, const Eigen::Isometry3d& T_odom_keyframe) {
  for (const MapFix& fix : fixes) {
    if (is_position(fix)) {
      pairs_.push_back({.p_map = T_odom_keyframe * fix.p_keyframe_antenna,
                        .p_world = frame_.position_of(fix.place),
                        .covariance = fix.covariance,
                        .time = seconds(fix.stamp)});
    }
  }
}

std::optional<ExpectedStart> StartByFixes::find(const Eigen::Vector3d& up_odom,
                                                const Eigen::Isometry3d& T_odom_keyframe) const {
  const Eigen::Isometry3d level(
      Eigen::Quaterniond::FromTwoVectors(up_odom, Eigen::Vector3d::UnitZ()));
  std::vector<PositionPair> pairs = pairs_;
  for (PositionPair& pair : pairs) {
    pair.p_map = level * pair.p_map;
  }
  const std::optional<WorldFit> fit = fit_world(pairs, correlation_);
  if (!fit || 2 * fit->agreeing < pairs.size() || !(fit->yaw_sigma <= kGuessedAngle)) {
    return std::nullopt;
  }
  const Eigen::Isometry3d T_map_odom =
      georeference_.T_world_map.inverse() * fit->T_world_map * level;
  const Eigen::Isometry3d T_map_keyframe = T_map_odom * T_odom_keyframe;

  // Errors of fixes stay the same for a while, so that many of them know the place no better than
  // the last one does.
  Eigen::Matrix3d position = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    position = fit->agrees[i] ? pairs[i].covariance : position;
  }
  if (!use_height_) {
    position(2, 2) += kUnmeasuredHeight * kUnmeasuredHeight;
  }
  const Eigen::Matrix3d R_keyframe_world =
      (georeference_.T_world_map * T_map_keyframe).linear().transpose();
  Matrix6d covariance = covariance_of_guess() + moved_to(T_map_keyframe, georeference_.covariance);
  covariance.topLeftCorner<3, 3>() += R_keyframe_world * position * R_keyframe_world.transpose();
  return ExpectedStart{.T_map_odom = T_map_odom, .covariance = symmetric(covariance)};
}

}  // namespace adit
