// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/motion_shares.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

constexpr int kBoth = 2 * kStateSize;
constexpr double kMovesBySigmas = 3.0;

// Of a size that the compiler does not know: unrolled they would take it long.
using Matrix = Eigen::MatrixXd;

Matrix both_of(const LinkQuadratic& link) {
  Matrix h(kBoth, kBoth);
  h << link.h_from, link.h_cross, link.h_cross.transpose(), link.h_to;
  return h;
}

/// Inverse of a positive matrix whose units differ by many decades; none where it is not positive.
std::optional<Matrix> scaled_inverse(const Matrix& h) {
  const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Matrix> llt(Matrix(scale.asDiagonal() * h * scale.asDiagonal()));
  if (llt.info() != Eigen::Success) {
    return std::nullopt;
  }
  const Matrix inverse = llt.solve(Matrix::Identity(h.rows(), h.cols()));
  return Matrix(scale.asDiagonal() * inverse * scale.asDiagonal());
}

/// Derivative of the motion between the states ([rho, phi], axes of the later one) by both.
Matrix motion_by_both(const Eigen::Isometry3d& T_from_to) {
  Matrix by_both = Matrix::Zero(kBoth, 6);
  by_both.topRows<6>() = -adjoint(T_from_to.inverse()).transpose();
  by_both.middleRows<6>(kStateSize).setIdentity();
  return by_both;
}

}  // namespace

void MotionLedger::start(const StateMatrix& information) {
  newest_.fill(StateMatrix::Zero());
  newest_[static_cast<std::size_t>(MotionSource::start)] = information;
  started_ = true;
}

std::optional<MotionShares> MotionLedger::add(const StepInformation& step, const NavState& from,
                                              const NavState& to) {
  if (!started_) {
    return std::nullopt;
  }
  std::array<Matrix, kMotionSources> parts;
  parts.fill(Matrix::Zero(kBoth, kBoth));
  const auto part = [&](MotionSource source) -> Matrix& {
    return parts[static_cast<std::size_t>(source)];
  };
  part(MotionSource::range).bottomRightCorner<kStateSize, kStateSize>() = step.range.h;
  part(MotionSource::imu) = both_of(step.imu);
  part(MotionSource::velocity) = both_of(step.velocity);
  part(MotionSource::doppler) = both_of(step.doppler);
  Matrix sum = Matrix::Zero(kBoth, kBoth);
  for (std::size_t i = 0; i < kMotionSources; ++i) {
    parts[i].topLeftCorner<kStateSize, kStateSize>() += newest_[i];
    sum += parts[i];
  }
  const auto covariance = scaled_inverse(sum);
  const auto before = scaled_inverse(sum.topLeftCorner<kStateSize, kStateSize>());
  if (!covariance || !before) {
    started_ = false;
    return std::nullopt;
  }

  const Eigen::Isometry3d T_from_to = from.T_map_body.inverse() * to.T_map_body;
  const Matrix by_both = motion_by_both(T_from_to);
  const Matrix moves = *covariance * by_both;
  const Matrix6d motion = by_both.transpose() * moves;
  const Eigen::Vector3d up = -to.gravity_map.normalized();
  Eigen::Vector3d path = to.T_map_body.translation() - from.T_map_body.translation();
  path -= up.dot(path) * up;
  const Eigen::Matrix3d R_body_map = to.T_map_body.linear().transpose();
  const auto in_body = [&](const Eigen::Vector3d& axis) -> Eigen::Vector3d {
    return R_body_map * axis.normalized();
  };
  MotionShares shares;
  const Eigen::Vector3d along = in_body(path);
  shares.moved =
      path.norm() > kMovesBySigmas * std::sqrt(along.dot(motion.topLeftCorner<3, 3>() * along));
  const std::array<Eigen::Vector3d, 3> axes = {along, in_body(up.cross(path)), in_body(up)};
  const Eigen::Matrix3d turn = motion.bottomRightCorner<3, 3>().inverse();
  Matrix kept(kStateSize, kBoth);
  kept << -sum.bottomLeftCorner<kStateSize, kStateSize>() * *before, StateMatrix::Identity();
  for (std::size_t i = 0; i < kMotionSources; ++i) {
    const Matrix6d noise = moves.transpose() * parts[i] * moves;
    for (std::size_t k = shares.moved ? 0 : 2; k < axes.size(); ++k) {
      shares.of[i][k] = axes[k].dot(noise.topLeftCorner<3, 3>() * axes[k]) /
                        axes[k].dot(motion.topLeftCorner<3, 3>() * axes[k]);
    }
    shares.of[i][3] = (turn * noise.bottomRightCorner<3, 3>()).trace() / 3.0;
    const StateMatrix next = kept * parts[i] * kept.transpose();
    newest_[i] = 0.5 * (next + next.transpose());
  }
  return shares;
}

}  // namespace adit
