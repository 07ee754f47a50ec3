// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/fused_motion.hpp"

#include <array>
#include <utility>

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

// chi squared that 99.9 % stay below, by degrees of freedom.
constexpr std::array kChiSquared999 = {0.0, 10.83, 13.82, 16.27, 18.47, 20.52, 22.46};
// Alignments err more than their covariances say: by three times in woods.
constexpr double kBeyondBelief = 10.0;
constexpr int kSurprises = 3;          // in a row are a failure
constexpr double kLongestAlone = 3.0;  // s by inertia alone

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

FusedMotion::FusedMotion(const GraphSettings& settings, const SensorStart& start)
    : graph_(settings) {
  graph_.start(prior_of(start));
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
                             const Eigen::Isometry3d& T_body_lidar, const CheckContext& context) {
  Pending pending = *std::exchange(pending_, std::nullopt);
  const double elapsed = seconds(pending.prediction.state.stamp - graph_.latest().stamp);
  alone_ = alignment != nullptr ? 0.0 : alone_ + elapsed;
  FusedSweep result{.outcome = StateEstimate{}};
  std::optional<PoseMeasurement> measurement;
  if (alignment != nullptr) {
    measurement = measured_pose(*alignment, kWhiteModel, T_body_lidar);
    result.innovation = innovation(pending.prediction, *measurement);
    const auto degrees = static_cast<size_t>(measurement->known_directions);
    result.innovation_gate = kBeyondBelief * kChiSquared999[degrees];
    surprises_ = result.innovation.nis > result.innovation_gate ? surprises_ + 1 : 0;
  }
  const GraphEstimate fused = graph_.add(std::move(pending.readings), measurement);
  if (const auto* failure = std::get_if<GraphFailure>(&fused)) {
    result.outcome = check_of(*failure, StateQuantity::state);
  } else if (const auto failed = failed_check(std::get<StateEstimate>(fused), context)) {
    result.outcome = *failed;
  } else {
    result.outcome = std::get<StateEstimate>(fused);
    ++sweeps_;
  }
  return result;
}

std::optional<FailedCheck> FusedMotion::failed_check(const StateEstimate& estimate,
                                                     const CheckContext& context) const {
  if (const auto impossible = impossible_state(estimate, context.before)) {
    return *impossible;
  }
  if (surprises_ >= kSurprises) {
    return AlignmentsContradict{
        .alignments = surprises_, .timed = context.timed, .sign_assumed = context.sign_assumed};
  }
  if (alone_ > kLongestAlone) {
    return NotAligned{.duration = alone_, .limit = kLongestAlone};
  }
  return std::nullopt;
}

}  // namespace adit
