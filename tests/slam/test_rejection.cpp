// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/rejection.hpp"

#include <chrono>
#include <cmath>
#include <optional>
#include <variant>

#include <gtest/gtest.h>

#include "adit/slam/odometry/possible_pose.hpp"

namespace adit {
namespace {

RegistrationResult fit(double overlap, double rms = 0.045, double x = 0.0) {
  RegistrationResult result;
  result.status = RegistrationStatus::converged;
  result.overlap = overlap;
  result.residual_rms = rms;
  result.T_target_source.translation().x() = x;
  for (size_t i = 0; i < 3; ++i) {
    result.translation[i].axis = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i));
    result.translation[i].localizability = Localizability::full;
  }
  return result;
}

UsualFit usual() {
  UsualFit fits;
  for (int i = 0; i < 20; ++i) {
    fits.add(fit(i % 2 == 0 ? 0.92 : 0.96));
  }
  return fits;
}

Prediction lost_far_away() {
  Prediction prediction;
  prediction.lost = true;
  prediction.T_map_lidar.translation().x() = 100.0;
  prediction.T_map_onward.translation().x() = 100.0;
  return prediction;
}

/// An alignment from a velocity of one sweep, or after a failure, that ends far from it.
Prediction untrusted_far_away() {
  Prediction prediction = lost_far_away();
  prediction.lost = false;
  return prediction;
}

/// The rejection where it is of that kind, with its figures.
template <class Kind>
std::optional<Kind> as(const std::optional<Rejection>& rejection) {
  return rejection && std::holds_alternative<Kind>(*rejection)
             ? std::optional(std::get<Kind>(*rejection))
             : std::nullopt;
}

TEST(UsualFit, WhatFitsAsSweepsDidBeforeIsBelieved) {
  EXPECT_FALSE(usual().rejection(fit(0.9), lost_far_away()));
  EXPECT_FALSE(usual().rejection(fit(0.9), untrusted_far_away()));
}

TEST(UsualFit, AWorseFitIsRejectedWithItsFigures) {
  const auto sparse = as<OverlapFallsShort>(usual().rejection(fit(0.4), untrusted_far_away()));
  ASSERT_TRUE(sparse);
  EXPECT_EQ(sparse->overlap, 0.4);
  EXPECT_NEAR(sparse->usual, 0.94, 0.002);
  const auto coarse = as<ResidualTooLarge>(usual().rejection(fit(0.9, 0.09), lost_far_away()));
  ASSERT_TRUE(coarse);
  EXPECT_EQ(coarse->rms, 0.09);
  EXPECT_NEAR(coarse->usual, 0.045, 1e-9);
}

TEST(UsualFit, AWorseFitThanUsualIsReasonToSearchAgain) {
  EXPECT_FALSE(usual().falls_short(fit(0.9)));
  EXPECT_TRUE(usual().falls_short(fit(0.6)));
  EXPECT_TRUE(usual().falls_short(fit(0.9, 0.09)));
  RegistrationResult failed = fit(0.9);
  failed.status = RegistrationStatus::not_converged;
  EXPECT_TRUE(usual().falls_short(failed));
  EXPECT_FALSE(UsualFit().falls_short(fit(0.4))) << "nothing is usual yet";
}

TEST(UsualFit, ATrustedPredictionIsConfirmedNearItAndRejectedAway) {
  Prediction trusted;
  trusted.trusted = true;
  EXPECT_FALSE(usual().rejection(fit(0.4, 0.045, 0.1), trusted));
  EXPECT_TRUE(as<OverlapFallsShort>(usual().rejection(fit(0.4, 0.045, 0.4), trusted)));
  EXPECT_FALSE(usual().rejection(fit(0.9, 0.045, 0.4), trusted));
}

TEST(UsualFit, WhereTheVelocityLedLessIsEnough) {
  EXPECT_FALSE(usual().rejection(fit(0.4, 0.1, 99.5), untrusted_far_away()));
  EXPECT_FALSE(usual().rejection(fit(0.4, 0.1, 99.5), lost_far_away()));
}

TEST(UsualFit, WithoutHabitsASearchIsBelieved) {
  UsualFit fits = usual();
  fits.forget();
  EXPECT_FALSE(fits.rejection(fit(0.4), untrusted_far_away()));
}

TEST(UsualFit, ASearchThatEndsElsewhereMustBeHeldThere) {
  RegistrationResult result = fit(0.94);
  result.translation[0].localizability = Localizability::none;
  EXPECT_TRUE(as<NotHeldAlong>(usual().rejection(result, untrusted_far_away())));
  Prediction near = untrusted_far_away();
  near.T_map_lidar = result.T_target_source;
  EXPECT_FALSE(usual().rejection(result, near)) << "where it was expected";
  EXPECT_FALSE(UsualFit().rejection(result, untrusted_far_away())) << "nothing is usual yet";
}

TEST(UsualFit, TwoPlacesThatFitAreNone) {
  RegistrationResult result = fit(0.94);
  result.competing_share = 0.95;
  const auto two = as<TwoPlaces>(usual().rejection(result, lost_far_away()));
  ASSERT_TRUE(two);
  EXPECT_EQ(two->competing_share, 0.95);
  result.competing_share = 0.6;
  EXPECT_FALSE(usual().rejection(result, lost_far_away()));
}

TEST(UsualFit, ALostSensorMustBeHeldAlongTheGroundButNotInHeight) {
  RegistrationResult result = fit(0.94);
  result.status = RegistrationStatus::degenerate;
  result.translation[2].localizability = Localizability::none;
  EXPECT_FALSE(usual().rejection(result, lost_far_away()));
  result.translation[0].localizability = Localizability::none;
  EXPECT_TRUE(as<NotHeldAlong>(usual().rejection(result, lost_far_away())));
  // The lidar lies on its side: its x is the map's z.
  result.T_target_source.linear() =
      Eigen::AngleAxisd(1.5708, Eigen::Vector3d::UnitY()).toRotationMatrix();
  result.translation[2].localizability = Localizability::full;
  EXPECT_FALSE(usual().rejection(result, lost_far_away()));
}

/// What becomes of an alignment after so many seconds on foot along x.
std::optional<Rejection> after_silence(const RegistrationResult& alignment,
                                       const UsualFit& fits = usual(), double elapsed = 1.5) {
  Vector6d velocity = Vector6d::Zero();
  velocity.x() = 1.2;
  const Silence silence = silence_after(Eigen::Isometry3d::Identity(), velocity, 1.2, elapsed);
  return fits.rejection_after(silence, alignment, alignment.T_target_source);
}

TEST(UsualFit, AfterASilenceAPlaceMustFitAndBeWithinReach) {
  EXPECT_FALSE(after_silence(fit(0.9, 0.045, 1.5)));
  EXPECT_FALSE(after_silence(fit(0.9, 0.045, 4.0)));
  const auto far = as<BeyondMotion>(after_silence(fit(0.95, 0.045, 7.0)));
  ASSERT_TRUE(far);
  EXPECT_EQ(far->distance, 7.0);
  EXPECT_EQ(far->seconds, 1.5);
  RegistrationResult upside_down = fit(0.95, 0.045, 1.5);
  upside_down.T_target_source.linear() =
      Eigen::AngleAxisd(3.1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_FALSE(after_silence(upside_down)) << "a turn by 180 degrees takes three sigma";
  upside_down.T_target_source.translation().x() = 4.0;
  EXPECT_TRUE(as<BeyondMotion>(after_silence(upside_down)));
}

TEST(UsualFit, AfterAShortSilenceTheVelocityConfirmsAWorseFit) {
  EXPECT_FALSE(after_silence(fit(0.4, 0.045, 1.55)));
  EXPECT_TRUE(as<OverlapFallsShort>(after_silence(fit(0.4, 0.045, 3.0))));
}

// After 2 s the velocity leads to within 1.4 m only.
TEST(UsualFit, AfterALongerSilenceTheVelocityAloneIsNoEvidence) {
  const auto later = [](const RegistrationResult& alignment, const UsualFit& fits = usual()) {
    return after_silence(alignment, fits, 2.0);
  };
  EXPECT_FALSE(later(fit(0.9, 0.045, 1.98)));
  EXPECT_TRUE(as<OverlapFallsShort>(later(fit(0.4, 0.045, 1.98))));
  EXPECT_TRUE(as<ResidualTooLarge>(later(fit(0.9, 0.09, 1.98))));
  EXPECT_TRUE(as<NothingUsual>(later(fit(0.9, 0.045, 1.98), UsualFit())));
  RegistrationResult twin = fit(0.94, 0.045, 1.98);
  twin.competing_share = 0.95;
  EXPECT_TRUE(as<TwoPlaces>(later(twin)));
  RegistrationResult tunnel = fit(0.94, 0.045, 1.98);
  tunnel.translation[0].localizability = Localizability::none;
  EXPECT_TRUE(as<NotHeldAlong>(later(tunnel)));
}

TEST(PossiblePose, NothingMovesFartherThanItCan) {
  StampedPose last{std::chrono::seconds(10), Eigen::Isometry3d::Identity()};
  StampedPose pose{std::chrono::seconds(11), Eigen::Isometry3d::Identity()};
  pose.pose.translation().x() = 20.9;
  EXPECT_FALSE(impossible_pose(pose, last, 20.0)) << "a metre more than the speed allows is spared";
  EXPECT_FALSE(impossible_pose(pose, std::nullopt, 1.0)) << "it is the first";
  pose.pose.translation().x() = 21.1;
  const auto far = as<MovedTooFar>(impossible_pose(pose, last, 20.0));
  ASSERT_TRUE(far);
  EXPECT_DOUBLE_EQ(far->distance, 21.1);
  EXPECT_DOUBLE_EQ(far->elapsed, 1.0);
  EXPECT_DOUBLE_EQ(far->max_speed, 20.0);
  pose.pose.translation().x() = std::nan("");
  EXPECT_TRUE(as<PoseNotFinite>(impossible_pose(pose, last, 20.0)));
}

}  // namespace
}  // namespace adit
