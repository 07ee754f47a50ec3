// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/spline.hpp"

#include <algorithm>
#include <stdexcept>

#include "adit/tools/simulator/repeatable_math.hpp"

namespace adit {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// How much of each of the three steps is done, and the derivatives of that by u.
struct Basis {
  std::array<double, 3> value;
  std::array<double, 3> first;
  std::array<double, 3> second;
};

Basis basis_at(double u) {
  const double u2 = u * u;
  const double u3 = u2 * u;
  return {.value = {(5.0 + 3.0 * u - 3.0 * u2 + u3) / 6.0,
                    (1.0 + 3.0 * u + 3.0 * u2 - 2.0 * u3) / 6.0, u3 / 6.0},
          .first = {(1.0 - 2.0 * u + u2) / 2.0, (1.0 + 2.0 * u - 2.0 * u2) / 2.0, u2 / 2.0},
          .second = {u - 1.0, 1.0 - 2.0 * u, u}};
}

}  // namespace

SplineTrajectory::SplineTrajectory(double spacing, std::vector<Eigen::Isometry3d> control_poses)
    : spacing_(spacing) {
  if (!(spacing > 0.0) || control_poses.size() < 4) {
    throw std::logic_error("SplineTrajectory: needs a positive spacing and four poses");
  }
  for (std::size_t i = 0; i + 3 < control_poses.size(); ++i) {
    Segment segment;
    segment.rotation = control_poses[i].linear();
    segment.position = control_poses[i].translation();
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Isometry3d& from = control_poses[i + k];
      const Eigen::Isometry3d& to = control_poses[i + k + 1];
      segment.turns[k] = repeatable_so3_log(from.linear().transpose() * to.linear());
      segment.moves[k] = to.translation() - from.translation();
    }
    segments_.push_back(segment);
  }
}

SplineTrajectory SplineTrajectory::cut_out(double begin, double length) const {
  SplineTrajectory cut = *this;
  cut.cut_begin_ = begin;
  cut.cut_length_ = length;
  return cut;
}

SplineTrajectory::Place SplineTrajectory::find(double time) const {
  const double whole = time < cut_begin_ ? time : time + cut_length_;
  const double at = std::clamp(whole / spacing_, 0.0, static_cast<double>(segments_.size()));
  const auto index = std::min(static_cast<std::size_t>(at), segments_.size() - 1);
  return {&segments_[index], at - static_cast<double>(index)};
}

MotionState SplineTrajectory::at(double time) const {
  const auto [segment, u] = find(time);
  const Basis basis = basis_at(u);
  MotionState state;
  Matrix3d rotation = segment->rotation;
  Vector3d position = segment->position;
  Vector3d turning = Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Matrix3d step = repeatable_so3_exp(basis.value[k] * segment->turns[k]);
    rotation = rotation * step;
    turning = step.transpose() * turning + basis.first[k] * segment->turns[k];
    position += basis.value[k] * segment->moves[k];
    state.velocity += basis.first[k] / spacing_ * segment->moves[k];
    state.acceleration += basis.second[k] / (spacing_ * spacing_) * segment->moves[k];
  }
  state.T_world_body.linear() = rotation;
  state.T_world_body.translation() = position;
  state.angular_velocity = turning / spacing_;
  return state;
}

Eigen::Isometry3d SplineTrajectory::pose(double time) const {
  const auto [segment, u] = find(time);
  const Basis basis = basis_at(u);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = segment->rotation;
  pose.translation() = segment->position;
  for (std::size_t k = 0; k < 3; ++k) {
    pose.linear() = pose.linear() * repeatable_so3_exp(basis.value[k] * segment->turns[k]);
    pose.translation() += basis.value[k] * segment->moves[k];
  }
  return pose;
}

}  // namespace adit
