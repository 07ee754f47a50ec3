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

#include "adit/slam/core/chi_squared.hpp"
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
constexpr double kMedianChiSquared = 2.366;  // of three degrees of freedom
// As many sweeps as the sliding graph has states (imu.lag): among them an error that lasts adds up.
constexpr std::size_t kLasting = 20;

template <class Remembered, class Value>
double median_of(const std::deque<Remembered>& remembered, const Value& value) {
  std::vector<double> values;
  std::ranges::transform(remembered, std::back_inserter(values),
                         [&](const Remembered& one) { return value(one.innovation); });
  return median(std::move(values));
}

/// Covariance of a whitened residual by the predicted velocity and the calibration. The way errs as
/// the velocity does.
Eigen::Matrix3d whitened_common(const LinkFactor<3>& factor, const MeasuredDisplacement& measured,
                                const NavState& from, const StateEstimate& prediction) {
  const Eigen::Matrix3d by_velocity = measured.duration *
                                      factor.by_from.middleCols<3>(kPositionAt) *
                                      from.T_map_body.linear().transpose();
  const Eigen::Matrix3d by_calibration = factor.by_to.rightCols<3>();
  return by_velocity * prediction.covariance.block<3, 3>(kVelocityAt, kVelocityAt) *
             by_velocity.transpose() +
         by_calibration * prediction.covariance.block<3, 3>(kScaleAt, kScaleAt) *
             by_calibration.transpose();
}

}  // namespace

VelocityInnovation innovation(const MeasuredDisplacement& measured, const NavState& from,
                              const StateEstimate& prediction) {
  const NavState& to = prediction.state;
  const LinkFactor<3> factor = velocity_factor(measured, from, to);
  const Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity() + whitened_common(factor, measured, from, prediction);
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

VelocityReport VelocityWatch::judge(MeasuredDisplacement& measured, const NavState& from,
                                    const StateEstimate& prediction) {
  VelocityReport report{.source = measured.source,
                        .innovation = innovation(measured, from, prediction)};
  const Eigen::Matrix3d noise = measured.covariance / (measured.duration * measured.duration);
  const Eigen::Matrix3d unwhitening = noise.llt().matrixL();
  const Eigen::Matrix3d common = whitened_common(velocity_factor(measured, from, prediction.state),
                                                 measured, from, prediction);
  const bool moves = note({.innovation = report.innovation,
                           .noise = noise,
                           .common = unwhitening * common * unwhitening.transpose()});
  report.on_trial = on_trial();
  report.refused = contradicted();
  report.comparison = comparison();
  // An error that lasts does not average out: so many sweeps know no more than one of them.
  const LastingError lasting = moves ? lasting_error() : LastingError{};
  report.slips = lasting.chi2 > kChiSquared999[3];
  const double certain = std::max(0.0, 1.0 - kChiSquared95[3] / std::max(lasting.chi2, 1e-9));
  const Eigen::Vector3d way = measured.duration * lasting.mean;
  measured.covariance *= variance_scale();
  measured.covariance += certain * static_cast<double>(lasting.sweeps) * way * way.transpose();
  report.covariance = measured.covariance / (measured.duration * measured.duration);
  return report;
}

bool VelocityWatch::note(const Remembered& one) {
  const VelocityInnovation& innovation = one.innovation;
  const double speed = std::max(innovation.measured.norm(), innovation.predicted.norm());
  if (!std::isfinite(innovation.nis) || speed < kSigmas * innovation.sigma) {
    return false;
  }
  moving_.push_back(one);
  if (moving_.size() > kRemembered) {
    moving_.pop_front();
  }
  return true;
}

double VelocityWatch::variance_scale() const {
  return on_trial() ? 1.0 : std::max(1.0, median_of(moving_, [](const auto& one) {
                                            return one.nis;
                                          }) / kMedianChiSquared);
}

LastingError VelocityWatch::lasting_error() const {
  LastingError lasting;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d common = Eigen::Matrix3d::Zero();
  const double scale = variance_scale();
  const std::size_t most = std::min(kLasting, moving_.size());
  for (std::size_t count = 1; count <= most; ++count) {
    const Remembered& one = moving_[moving_.size() - count];
    const auto n = static_cast<double>(count);
    sum += one.innovation.error;
    noise += scale * one.noise;
    common += one.common;
    const Eigen::Vector3d mean = sum / n;
    const Eigen::Matrix3d covariance = noise / (n * n) + common / n;
    const double chi2 = mean.dot(covariance.ldlt().solve(mean));
    if (chi2 > lasting.chi2) {
      lasting = {.mean = mean, .sweeps = count, .chi2 = chi2};
    }
  }
  return lasting;
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
  for (const auto& [one, noise, common] : moving_) {
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
