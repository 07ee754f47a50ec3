// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/rejection.hpp"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr int kUsual = 10;              // alignments make a habit, and as many are remembered
constexpr double kLeastShare = 0.7;     // times the usual overlap
constexpr double kSearchBelow = 0.8;    // times the usual overlap
constexpr int kFewForSearch = 3;        // alignments are enough to compare with before a search
constexpr double kMostRms = 1.4;        // times the usual residual
constexpr double kMostCompeting = 0.9;  // share of the matched points
constexpr double kLevel = 0.7;          // z of a direction: less is along the ground
constexpr double kNearDistance = 1.0;   // m from the prediction
constexpr double kNearTurn = 0.3;       // rad
constexpr double kNearSigmas = 2.0;     // standard deviations of a trusted prediction

/// How well the place along the ground is held. (Height is another matter: floors that a sensor
/// does not see are common, and nobody jumps.)
Localizability along_ground(const RegistrationResult& alignment) {
  Localizability weakest = Localizability::full;
  for (const ObservedDirection& direction : alignment.translation) {
    const Eigen::Vector3d axis = alignment.T_target_source.linear() * direction.axis;
    weakest = std::abs(axis.z()) < kLevel ? std::max(weakest, direction.localizability) : weakest;
  }
  return weakest;
}

bool is_near(const RegistrationResult& alignment, const Eigen::Isometry3d& expected) {
  const Eigen::Isometry3d off = expected.inverse() * alignment.T_target_source;
  return off.translation().norm() < kNearDistance && rotation_angle(off.linear()) < kNearTurn;
}

}  // namespace

bool is_within(const RegistrationResult& alignment, const Prediction& prediction, double sigmas) {
  const Vector6d off = se3_log(prediction.T_map_lidar.inverse() * alignment.T_target_source);
  return (off.array().abs() < sigmas * prediction.sigma.array()).all();
}

void UsualFit::add(const RegistrationResult& alignment) {
  alignments_ = std::min(alignments_ + 1, kUsual);
  overlap_ += (alignment.overlap - overlap_) / alignments_;
  rms_ += (alignment.residual_rms - rms_) / alignments_;
}

bool UsualFit::falls_short(const RegistrationResult& alignment) const {
  return !is_usable(alignment.status) ||
         (alignments_ >= kFewForSearch && (alignment.overlap < kSearchBelow * overlap_ ||
                                           alignment.residual_rms > kMostRms * rms_));
}

std::optional<Rejection> UsualFit::rejection(const RegistrationResult& alignment,
                                             const Prediction& prediction) const {
  const Localizability held = along_ground(alignment);
  if (prediction.lost && held == Localizability::none) {
    return NotHeldAlong{};
  }
  // Where matches and velocity agree, one confirms the other.
  const bool agree =
      prediction.lost ? held == Localizability::full && is_near(alignment, prediction.T_map_onward)
                      : (prediction.trusted ? is_within(alignment, prediction, kNearSigmas)
                                            : is_near(alignment, prediction.T_map_lidar));
  if (agree) {
    return std::nullopt;
  }
  if (held == Localizability::none && alignments_ > 0) {
    return NotHeldAlong{};
  }
  if (alignments_ >= kUsual && alignment.overlap < kLeastShare * overlap_) {
    return OverlapFallsShort{.overlap = alignment.overlap, .usual = overlap_};
  }
  if (!prediction.lost && !prediction.trusted) {
    return std::nullopt;
  }
  if (alignments_ >= kUsual && alignment.residual_rms > kMostRms * rms_) {
    return ResidualTooLarge{.rms = alignment.residual_rms, .usual = rms_};
  }
  if (alignment.competing_share > kMostCompeting) {
    return TwoPlaces{.competing_share = alignment.competing_share};
  }
  return std::nullopt;
}

std::optional<Rejection> UsualFit::rejection_after(const Silence& silence,
                                                   const RegistrationResult& alignment,
                                                   const Eigen::Isometry3d& moved) const {
  const Localizability held = along_ground(alignment);
  if (held == Localizability::none) {
    return NotHeldAlong{};
  }
  if (chi2_of(silence, alignment.T_target_source) > kSilenceGate) {
    return BeyondMotion{.distance = moved.translation().norm(),
                        .turn = rotation_angle(moved.linear()),
                        .seconds = silence.seconds};
  }
  // Where matches and velocity agree, one confirms the other, while the velocity says where it is.
  const bool leads = silence.sigma.head<3>().maxCoeff() < kNearDistance;
  if (leads && held == Localizability::full && is_near(alignment, silence.T_map_lidar)) {
    return std::nullopt;
  }
  if (alignments_ < kFewForSearch) {
    return NothingUsual{};
  }
  if (alignment.overlap < kLeastShare * overlap_) {
    return OverlapFallsShort{.overlap = alignment.overlap, .usual = overlap_};
  }
  if (alignment.residual_rms > kMostRms * rms_) {
    return ResidualTooLarge{.rms = alignment.residual_rms, .usual = rms_};
  }
  if (alignment.competing_share > kMostCompeting) {
    return TwoPlaces{.competing_share = alignment.competing_share};
  }
  return std::nullopt;
}

}  // namespace adit
