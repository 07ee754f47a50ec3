// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/verdict_text.hpp"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tools/report/run_assessment.hpp"
#include "adit/tools/report/run_statistics.hpp"

namespace adit {
namespace {

TEST(VerdictText, LoopsThatMovedTheMapFartherThanTheOdometryBearsOutAreDoubtfulWithTheFigure) {
  RunStatistics statistics{Config{}};
  const auto assessed = [&] { return assess_run(RunDescription{}, RunOutcome{}, statistics); };
  statistics.note({.distance = 0.3, .sigmas = 1.2, .path = 100.0});
  EXPECT_EQ(assessed().trust, Trust::reliable) << "what a healthy map has";
  EXPECT_FALSE(to_json(assessed(), Nanoseconds(0)).contains("moved_by_loops"));

  statistics.note({.distance = 8.31, .sigmas = 41.0, .path = 120.0});
  EXPECT_EQ(assessed().trust, Trust::doubtful);
  const std::string text = describe(assessed(), Nanoseconds(0), 9);
  EXPECT_TRUE(
      text.starts_with("doubtful\n         loops moved the map by 8.31 m over a path of "
                       "120 m, 41.0 standard deviations of the odometry"))
      << text;
  const auto json = to_json(assessed(), Nanoseconds(0));
  EXPECT_EQ(json["state"], "doubtful");
  EXPECT_EQ(json["moved_by_loops"]["sigmas"], 41.0);
  EXPECT_EQ(json["reasons"][0]["cause"], "loops");
}

TEST(VerdictText, WhatLoopsDidDoesNotMakeALostRunBetter) {
  const Verdict lost{.trust = Trust::lost,
                     .stretches = {{.cause = DoubtCause::predicted, .trust = Trust::lost}}};
  const Verdict both = with_loops(lost, {.distance = 5.0, .sigmas = 9.0, .path = 50.0});
  EXPECT_EQ(both.trust, Trust::lost);
  EXPECT_EQ(both.moved->sigmas, 9.0);
}

}  // namespace
}  // namespace adit
