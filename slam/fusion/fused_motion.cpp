// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/fused_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

#include "adit/slam/core/chi_squared.hpp"
#include "adit/slam/core/median.hpp"
#include "adit/slam/fusion/state_checks.hpp"

namespace adit {
namespace {

// Surfaces larger than usual do not count against them: in open fields, where they are, graphs that
// trusted alignments that much less went astray on readings alone.
constexpr CovarianceModel kWhiteModel{.kappa = 0.3,
                                      .area = 0.016,
                                      .most_sparse = 1.0,
                                      .sigma_translation = 0.002,
                                      .sigma_rotation = 0.0003};

// Alignments err more than their covariances say: by three times in woods.
constexpr double kOutlierGateScale = 10.0;
constexpr double kSurprises = 3.0;  // in a row are a failure
// Alignments with weak directions lock into wrong places for a while: rings of the ground on rings
// of the ground. So much of a surprise they are.
constexpr double kWeakSurprise = 0.25;
constexpr size_t kUsual = 15;         // alignments that tell what is usual
constexpr double kLeastScale = 0.05;  // of variances
constexpr double kMostScale = 20.0;
constexpr double kLongestAlone = 3.0;  // s by inertia alone

bool holds_all(const RegistrationResult& alignment) {
  const auto is_held = [](const ObservedDirection& direction) {
    return direction.localizability == Localizability::full || direction.axis.isZero();
  };
  return std::ranges::all_of(alignment.translation, is_held) &&
         std::ranges::all_of(alignment.rotation, is_held);
}

/// What a graph that fails is, of a prediction or of a fused state.
FailedCheck check_of(GraphFailure failure, StateQuantity quantity) {
  switch (failure) {
    case GraphFailure::not_finite:
      return ImpossibleState{.quantity = quantity};
    case GraphFailure::undetermined:
      break;
  }
  return StateUndetermined{};
}

}  // namespace

Eigen::Isometry3d matched_pose(const RegistrationResult& alignment) {
  return measured_pose(alignment, kWhiteModel, Eigen::Isometry3d::Identity()).T_map_body;
}

// What all alignments err by alike is an error between the prediction and the matches, too.
Matrix6d pose_prior(const Matrix6d& lidar_covariance, double inflation) {
  Vector6d floor;
  floor << Eigen::Vector3d::Constant(kWhiteModel.sigma_translation),
      Eigen::Vector3d::Constant(kWhiteModel.sigma_rotation);
  Matrix6d covariance = lidar_covariance;
  covariance.diagonal() += floor.cwiseAbs2();
  const Matrix6d information = inflation * covariance.ldlt().solve(Matrix6d::Identity());
  return 0.5 * (information + information.transpose());
}

Matrix6d pose_prior(const Matrix6d& lidar_covariance) {
  return pose_prior(lidar_covariance, kWhiteModel.kappa);
}

bool is_outlier(const Eigen::Isometry3d& T_map_lidar, const Matrix6d& covariance,
                const RegistrationResult& alignment) {
  PoseMeasurement measurement =
      measured_pose(alignment, kWhiteModel, Eigen::Isometry3d::Identity());
  measurement.root_information /= std::sqrt(kOutlierGateScale);
  StateEstimate prediction;
  prediction.state.T_map_body = T_map_lidar;
  prediction.covariance.topLeftCorner<6, 6>() = covariance;
  return innovation(prediction, measurement).nis >
         kChiSquared999[static_cast<size_t>(measurement.known_directions)];
}

FusedMotion::FusedMotion(const GraphSettings& settings, const SensorStart& start,
                         const CalibrationSigma& calibration)
    : graph_(settings),
      watches_{VelocityWatch(calibration.scale), VelocityWatch(calibration.scale)},
      inflation_(kWhiteModel.kappa) {
  graph_.start(prior_of(start, calibration));
}

std::variant<StateEstimate, FailedCheck> FusedMotion::predict(std::vector<ImuSample> readings) {
  pending_.reset();
  const GraphEstimate predicted = graph_.predict(readings);
  if (const auto* failure = std::get_if<GraphFailure>(&predicted)) {
    return check_of(*failure, StateQuantity::prediction);
  }
  const auto& prediction = std::get<StateEstimate>(predicted);
  if (const auto impossible = impossible_motion(graph_.latest(), prediction)) {
    return FailedCheck(*impossible);
  }
  pending_ = Pending{.readings = std::move(readings), .prediction = prediction};
  return prediction;
}

FusedSweep FusedMotion::fuse(const RegistrationResult* alignment,
                             const Eigen::Isometry3d& T_body_lidar, const CheckContext& context,
                             std::vector<MeasuredDisplacement> ways) {
  Pending pending = *std::exchange(pending_, std::nullopt);
  const double elapsed = seconds(pending.prediction.state.stamp - graph_.latest().stamp);
  alone_ = alignment != nullptr ? 0.0 : alone_ + elapsed;
  FusedSweep result{.outcome = StateEstimate{}};
  std::optional<PoseMeasurement> measurement;
  if (alignment != nullptr) {
    measurement = measured_pose(*alignment, kWhiteModel, T_body_lidar);
    inflation_ = inflation(*alignment, kWhiteModel);
    result.innovation = innovation(pending.prediction, *measurement);
    const auto degrees = static_cast<size_t>(measurement->known_directions);
    result.innovation_gate = kOutlierGateScale * kChiSquared999[degrees];
    const double surprise = holds_all(*alignment) ? 1.0 : kWeakSurprise;
    const bool outlier = result.innovation.nis > result.innovation_gate;
    outliers_ = outlier ? outliers_ + 1 : 0;
    surprises_ = outlier ? surprises_ + surprise : 0.0;
    // A larger deviation than 95 % have, in units of the usual one, lowers the information.
    const double expected = kChiSquared95[degrees] * usual_innovation();
    if (context.sure && result.innovation.nis > expected) {
      measurement->root_information *= std::sqrt(expected / result.innovation.nis);
    }
    note(result.innovation);
    result.scale = error_scale();
  }
  std::vector<MeasuredDisplacement> trusted;
  for (MeasuredDisplacement& way : ways) {
    VelocityWatch& watch = watches_[static_cast<size_t>(way.source)];
    const VelocityReport report = watch.judge(way, graph_.latest(), pending.prediction);
    result.velocities.push_back(report);
    if (report.fused()) {
      trusted.push_back(way);
    }
  }
  const GraphEstimate fused =
      graph_.add(std::move(pending.readings), measurement, std::move(trusted));
  if (const auto* failure = std::get_if<GraphFailure>(&fused)) {
    result.outcome = check_of(*failure, StateQuantity::state);
  } else if (const auto failed = failed_check(std::get<StateEstimate>(fused), context)) {
    result.outcome = *failed;
  } else {
    result.outcome = std::get<StateEstimate>(fused);
    result.shares = graph_.shares();
    ++sweeps_;
  }
  return result;
}

void FusedMotion::note(const Innovation& innovation) {
  if (innovation.degrees == 0 || !std::isfinite(innovation.nis)) {
    return;
  }
  innovations_.push_back(innovation.nis / innovation.degrees);
  if (innovations_.size() > kUsual) {
    innovations_.pop_front();
  }
}

// The median of the last alignments', a degree of freedom; at least what covariances promise.
double FusedMotion::usual_innovation() const {
  if (innovations_.empty()) {
    return 1.0;
  }
  return std::max(1.0, median({innovations_.begin(), innovations_.end()}));
}

double FusedMotion::error_scale() const {
  if (innovations_.size() < kUsual) {
    return 1.0;
  }
  const double sum = std::accumulate(innovations_.begin(), innovations_.end(), 0.0);
  return std::clamp(sum / static_cast<double>(innovations_.size()), kLeastScale, kMostScale);
}

std::optional<FailedCheck> FusedMotion::failed_check(const StateEstimate& estimate,
                                                     const CheckContext& context) const {
  if (const auto impossible = impossible_state(estimate, context.before)) {
    return *impossible;
  }
  if (surprises_ >= kSurprises) {
    return AlignmentsContradict{
        .alignments = outliers_, .timed = context.timed, .sign_assumed = context.sign_assumed};
  }
  if (alone_ > kLongestAlone) {
    return NotAligned{.duration = alone_, .limit = kLongestAlone};
  }
  return std::nullopt;
}

}  // namespace adit
