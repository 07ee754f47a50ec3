// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/velocity_watch.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "adit/slam/core/median.hpp"
#include "adit/slam/fusion/velocity_factor.hpp"

namespace adit {
namespace {

// Some seconds of motion, so that a burst of slip is not usual; and the fewest that show anything.
constexpr std::size_t kRemembered = 50;
constexpr std::size_t kFewest = 5;
// In standard deviations: the noise hides a slower motion, and does not explain a usual error that
// is larger.
constexpr double kSigmas = 3.0;
// An error of scale or direction that is usual by as much is not one that the calibration's prior
// allows for, in its standard deviations.
constexpr double kPriorSigmas = 4.0;
// chi squared of three degrees of freedom that half stay below.
constexpr double kMedianChiSquared = 2.366;

template <class Value>
double median_of(const std::deque<VelocityInnovation>& innovations, const Value& value) {
  std::vector<double> values;
  std::ranges::transform(innovations, std::back_inserter(values), value);
  return median(std::move(values));
}

double median_nis(const std::deque<VelocityInnovation>& of) {
  return median_of(of, &VelocityInnovation::nis);
}

}  // namespace

VelocityInnovation innovation(const MeasuredWay& measured, const NavState& from,
                              const StateEstimate& prediction) {
  const NavState& to = prediction.state;
  const LinkFactor<3> factor = velocity_factor(measured, from, to);
  // The way errs as the velocity does.
  const Eigen::Matrix3d by_velocity = measured.duration *
                                      factor.by_from.middleCols<3>(kPositionAt) *
                                      from.T_map_body.linear().transpose();
  const Eigen::Matrix3d by_calibration = factor.by_to.rightCols<3>();
  const Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity() +
      by_velocity * prediction.covariance.block<3, 3>(kVelocityAt, kVelocityAt) *
          by_velocity.transpose() +
      by_calibration * prediction.covariance.block<3, 3>(kScaleAt, kScaleAt) *
          by_calibration.transpose();
  const Eigen::Vector3d calibrated = measured.calibrated(to.velocity) / measured.duration;
  const Eigen::Isometry3d T_from_to = from.T_map_body.inverse() * to.T_map_body;
  const Eigen::Vector3d predicted =
      (T_from_to * measured.p_body_sensor - measured.p_body_sensor) / measured.duration;
  return {.measured = measured.way / measured.duration,
          .predicted = predicted,
          .error = predicted - calibrated,
          .sigma = std::sqrt(measured.covariance.diagonal().minCoeff()) / measured.duration,
          .nis = factor.residual.dot(covariance.ldlt().solve(factor.residual))};
}

VelocityReport VelocityWatch::judge(MeasuredWay& measured, const NavState& from,
                                    const StateEstimate& prediction) {
  VelocityReport report{.source = measured.source,
                        .innovation = innovation(measured, from, prediction)};
  note(report.innovation);
  // Doppler speeds are of the range sensor itself: who stands still is held by them.
  report.on_trial = measured.source == VelocitySource::sensor && on_trial();
  report.refused = contradicted();
  report.comparison = comparison();
  measured.covariance *= variance_scale();
  report.covariance = measured.covariance / (measured.duration * measured.duration);
  return report;
}

void VelocityWatch::note(const VelocityInnovation& innovation) {
  const double speed = std::max(innovation.measured.norm(), innovation.predicted.norm());
  if (!std::isfinite(innovation.nis) || speed < kSigmas * innovation.sigma) {
    return;
  }
  moving_.push_back(innovation);
  if (moving_.size() > kRemembered) {
    moving_.pop_front();
  }
}

double VelocityWatch::variance_scale() const {
  return on_trial() ? 1.0 : std::max(1.0, median_nis(moving_) / kMedianChiSquared);
}

bool VelocityWatch::on_trial() const {
  return moving_.size() < kFewest;
}

bool VelocityWatch::contradicted() const {
  if (on_trial() || variance_scale() < kSigmas * kSigmas) {
    return false;
  }
  const double error = median_of(moving_, [](const auto& one) { return one.error.norm(); });
  const double speed = median_of(moving_, [](const auto& one) { return one.predicted.norm(); });
  return error > kPriorSigmas * scale_sigma_ * speed;
}

// By the rotation and the scale of least squares, from the singular values of `mixed`; a body that
// goes straight shows no more of the rotation than how its direction is turned.
std::optional<VelocityComparison> VelocityWatch::comparison() const {
  if (on_trial()) {
    return std::nullopt;
  }
  Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();
  double measured = 0.0;
  double predicted = 0.0;
  for (const VelocityInnovation& one : moving_) {
    mixed += one.predicted * one.measured.transpose();
    measured += one.measured.squaredNorm();
    predicted += one.predicted.squaredNorm();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squared(mixed.transpose() * mixed);
  const double common = squared.eigenvalues().cwiseMax(0.0).cwiseSqrt().sum();
  const Eigen::Vector3d from = squared.eigenvectors().col(2);
  const double along = from.dot((mixed * from).normalized());
  const double scale = measured > 0.0 ? common / measured : 0.0;
  const auto count = static_cast<double>(moving_.size());
  return VelocityComparison{.speed = std::sqrt(predicted / count),
                            .measured_speed = std::sqrt(measured / count),
                            .scale = scale,
                            .turn = measured > 0.0 ? std::acos(std::clamp(along, -1.0, 1.0)) : 0.0,
                            .left = std::sqrt(std::max(0.0, predicted - scale * common) / count)};
}

}  // namespace adit
