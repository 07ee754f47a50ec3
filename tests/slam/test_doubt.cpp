// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/doubt.hpp"

#include <gtest/gtest.h>

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

bool says(const std::optional<std::string>& doubt, const char* text) {
  return doubt && doubt->find(text) != std::string::npos;
}

TEST(UsualFit, WhatFitsAsSweepsDidBeforeIsBelieved) {
  EXPECT_EQ(usual().doubt(fit(0.9), lost_far_away()), std::nullopt);
  EXPECT_EQ(usual().doubt(fit(0.9), untrusted_far_away()), std::nullopt);
}

TEST(UsualFit, AWorseFitIsDoubtedWithItsFigures) {
  const auto doubt = usual().doubt(fit(0.4), untrusted_far_away());
  EXPECT_TRUE(says(doubt, "40 %")) << doubt.value_or("believed");
  EXPECT_TRUE(says(doubt, "94 %")) << doubt.value_or("believed");
  const auto coarse = usual().doubt(fit(0.9, 0.09), lost_far_away());
  EXPECT_TRUE(says(coarse, "9.0 cm") && says(coarse, "4.5")) << coarse.value_or("believed");
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

TEST(UsualFit, ATrustedPredictionIsConfirmedNearItAndDoubtedAway) {
  Prediction trusted;
  trusted.trusted = true;
  EXPECT_EQ(usual().doubt(fit(0.4, 0.045, 0.1), trusted), std::nullopt);
  EXPECT_TRUE(says(usual().doubt(fit(0.4, 0.045, 0.4), trusted), "40 %"));
  EXPECT_EQ(usual().doubt(fit(0.9, 0.045, 0.4), trusted), std::nullopt);
}

TEST(UsualFit, WhereTheVelocityLedLessIsEnough) {
  EXPECT_EQ(usual().doubt(fit(0.4, 0.1, 99.5), untrusted_far_away()), std::nullopt);
  EXPECT_EQ(usual().doubt(fit(0.4, 0.1, 99.5), lost_far_away()), std::nullopt);
}

TEST(UsualFit, WithoutHabitsASearchIsBelieved) {
  UsualFit fits = usual();
  fits.forget();
  EXPECT_EQ(fits.doubt(fit(0.4), untrusted_far_away()), std::nullopt);
}

TEST(UsualFit, TwoPlacesThatFitAreNone) {
  RegistrationResult result = fit(0.94);
  result.rival = 0.95;
  EXPECT_TRUE(says(usual().doubt(result, lost_far_away()), "two places"));
  result.rival = 0.6;
  EXPECT_EQ(usual().doubt(result, lost_far_away()), std::nullopt);
}

TEST(UsualFit, ALostSensorMustBeHeldAlongTheGroundButNotInHeight) {
  RegistrationResult result = fit(0.94);
  result.status = RegistrationStatus::degenerate;
  result.translation[2].localizability = Localizability::none;
  EXPECT_EQ(usual().doubt(result, lost_far_away()), std::nullopt);
  result.translation[0].localizability = Localizability::none;
  EXPECT_TRUE(says(usual().doubt(result, lost_far_away()), "farther along"));
  // The lidar lies on its side: its x is the map's z.
  result.T_target_source.linear() =
      Eigen::AngleAxisd(1.5708, Eigen::Vector3d::UnitY()).toRotationMatrix();
  result.translation[2].localizability = Localizability::full;
  EXPECT_EQ(usual().doubt(result, lost_far_away()), std::nullopt);
}

}  // namespace
}  // namespace adit
