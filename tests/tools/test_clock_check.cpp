// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/clock_check.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

std::string reason_of(double least) {
  return explain_lateness(least).value_or("ordinary");
}

TEST(ClockCheck, KnowsWhatDifferencesComeFrom) {
  EXPECT_EQ(reason_of(0.12), "ordinary");
  EXPECT_EQ(reason_of(-0.01), "ordinary");
  EXPECT_NE(reason_of(-37.02).find("TAI"), std::string::npos);
  EXPECT_NE(reason_of(37.1).find("TAI"), std::string::npos);
  EXPECT_NE(reason_of(-7199.9).find("time zone"), std::string::npos);
  EXPECT_NE(reason_of(1.7e9).find("switched on"), std::string::npos);
  EXPECT_NE(reason_of(12.0).find("not set"), std::string::npos);
}

TEST(ClockCheck, ComparesTopicsWithTheMachineAndWithEachOther) {
  EXPECT_TRUE(clock_faults({{"/points", 0.11}, {"/imu", 0.002}}).empty());
  const auto faults = clock_faults({{"/points", 0.11}, {"/imu", -36.998}});
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_NE(faults[0].find("/imu are 36.998 s ahead of"), std::string::npos) << faults[0];
  EXPECT_NE(faults[1].find("37.108 s apart"), std::string::npos) << faults[1];
}

}  // namespace
}  // namespace adit
