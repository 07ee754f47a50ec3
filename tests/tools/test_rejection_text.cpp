// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Each rejection as people read it.
#include "adit/tools/report/rejection_text.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(RejectionText, PosesThatCannotBe) {
  EXPECT_EQ(describe(Rejection(PoseNotFinite{})), "the pose would not be finite");
  EXPECT_EQ(
      describe(Rejection(MovedTooFar{.distance = 123.45, .elapsed = 0.1, .max_speed = 100.0})),
      "it would have moved 123 m in 0.1 s (recovery.max_speed is 100 m/s)");
}

TEST(RejectionText, WhatASearchFound) {
  EXPECT_EQ(describe(Rejection(NotHeldAlong{})),
            "a search found a place that could as well be farther along: no match holds it there");
  EXPECT_EQ(describe(Rejection(OverlapFallsShort{.overlap = 0.404, .usual = 0.936})),
            "a search found a place where 40 % of its points match the submap, of sweeps before "
            "94 % did");
  EXPECT_EQ(describe(Rejection(ResidualTooLarge{.rms = 0.09, .usual = 0.045})),
            "a search found a place where its points lie 9.0 cm from the submap's surfaces, those "
            "of sweeps before 4.5");
  EXPECT_EQ(describe(Rejection(TwoPlaces{.competing_share = 0.95})),
            "a search found two places, and where one matches 100 points the other matches 95");
}

}  // namespace
}  // namespace adit
