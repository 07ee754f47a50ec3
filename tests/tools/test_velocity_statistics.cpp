// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/velocity_statistics.hpp"

#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace adit {
namespace {

bool says(const VelocityComparison& comparison, const std::string& what) {
  return describe(comparison).find(what) != std::string::npos;
}

TEST(VelocityFusionStatistics, SaysWhatIsWrongWithAVelocity) {
  EXPECT_TRUE(says({.speed = 2.0, .measured_speed = 0.01}, "stays near zero"));
  EXPECT_TRUE(says({.speed = 2.0, .measured_speed = 7.2, .scale = 1.0 / 3.6}, "km/h"));
  EXPECT_TRUE(says({.speed = 2.0, .measured_speed = 4.0, .scale = 0.5}, "2.00 times"));
  EXPECT_FALSE(says({.speed = 2.0, .measured_speed = 4.0, .scale = 0.5}, "km/h"));
  EXPECT_TRUE(
      says({.speed = 2.0, .measured_speed = 2.0, .scale = 1.0, .turn = std::numbers::pi}, "sign"));
  EXPECT_TRUE(
      says({.speed = 2.0, .measured_speed = 2.0, .scale = 1.0, .turn = 1.57}, "90 degrees"));
  EXPECT_TRUE(
      says({.speed = 2.0, .measured_speed = 2.0, .scale = 0.5, .turn = 0.1, .left = 1.0}, "late"));
}

SweepResult sweep(bool refused) {
  SweepResult result;
  result.inertial.nav = NavState{};
  result.inertial.nav->velocity.scale = 0.02;
  result.inertial.nav_covariance = 1e-4 * StateMatrix::Identity();
  VelocityReport report{.innovation = {.nis = 6.0}, .refused = refused};
  if (refused) {
    report.comparison = VelocityComparison{.speed = 1.0, .measured_speed = 0.0};
  }
  result.inertial.velocities.push_back(report);
  return result;
}

TEST(VelocityFusionStatistics, CountsWhatWasFusedAndWhatWasRefused) {
  VelocityFusionStatistics statistics;
  EXPECT_FALSE(statistics.any());
  EXPECT_TRUE(statistics.text().empty());
  statistics.add(sweep(false));
  statistics.add(sweep(false));
  statistics.add(sweep(true));
  SweepResult tried = sweep(false);
  tried.inertial.velocities.front().on_trial = true;
  statistics.add(tried);
  ASSERT_TRUE(statistics.any());
  const auto json = statistics.to_json();
  EXPECT_FALSE(json.contains("doppler"));
  EXPECT_EQ(json["sensor"]["sweeps"], 4);
  EXPECT_EQ(json["sensor"]["fused"], 2);
  EXPECT_EQ(json["sensor"]["refused"], 1);
  EXPECT_DOUBLE_EQ(json["sensor"]["innovation_squared_per_degree"], 2.0);
  EXPECT_DOUBLE_EQ(json["sensor"]["scale"], 1.02);
  ASSERT_EQ(statistics.text().size(), 1U);
  EXPECT_NE(statistics.text().front().find("2 of 4 sweeps fused"), std::string::npos);
  EXPECT_NE(statistics.text().front().find("stays near zero"), std::string::npos);
}

}  // namespace
}  // namespace adit
