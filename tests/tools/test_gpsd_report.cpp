// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/gpsd_report.hpp"

#include <chrono>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace adit {
namespace {

constexpr Nanoseconds kReceived = std::chrono::seconds(5);

const std::string kTpv =
    R"({"class":"TPV","mode":3,"status":3,"time":"2026-11-29T10:20:30.500Z","lat":49.1,"lon":8.4,)"
    R"("altHAE":163.5,"epx":1.96,"epy":3.92,"epv":5.88})";

TEST(GpsdReport, FixHasPositionTimeAndDeviations) {
  GpsdReports reports;
  const auto fix = reports.take(kTpv, kReceived);
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->stamp, std::chrono::milliseconds(1795947630500));
  EXPECT_EQ(fix->latitude, 49.1);
  EXPECT_EQ(fix->longitude, 8.4);
  EXPECT_EQ(fix->altitude, 163.5);
  EXPECT_EQ(fix->kind, GnssFixKind::ground_augmented);
  ASSERT_TRUE(fix->covariance);
  EXPECT_NEAR((*fix->covariance)(0, 0), 1.0, 1e-12);
  EXPECT_NEAR((*fix->covariance)(1, 1), 4.0, 1e-12);
  EXPECT_NEAR((*fix->covariance)(2, 2), 9.0, 1e-12);
}

TEST(GpsdReport, DeviationsOfTheSameTimeWin) {
  GpsdReports reports;
  const std::string gst = R"({"class":"GST","time":"2026-11-29T10:20:30.500Z","lat":0.02,)"
                          R"("lon":0.01,"alt":0.03})";
  EXPECT_FALSE(reports.take(gst, kReceived));
  const auto fix = reports.take(kTpv, kReceived);
  ASSERT_TRUE(fix);
  EXPECT_NEAR((*fix->covariance)(0, 0), 1e-4, 1e-12);
  EXPECT_NEAR((*fix->covariance)(1, 1), 4e-4, 1e-12);
  EXPECT_NEAR((*fix->covariance)(2, 2), 9e-4, 1e-12);
}

TEST(GpsdReport, WhatIsNoFixIsPassedOver) {
  GpsdReports reports;
  for (const char* line :
       {"", "{", "[]", "null", R"({"class":"VERSION"})", R"({"class":"TPV","mode":1})",
        R"({"class":"TPV","mode":2,"lat":1,"lon":2})",
        R"({"class":"TPV","mode":"3","lat":1,"lon":2,"altHAE":3})",
        R"({"class":7,"mode":3,"lat":1e999,"lon":2,"altHAE":3})"}) {
    EXPECT_FALSE(reports.take(line, kReceived)) << line;
  }
  const auto fix = reports.take(
      R"({"class":"TPV","mode":3,"time":"soon","lat":1,"lon":2,"altHAE":3})", kReceived);
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->stamp, kReceived);
  EXPECT_FALSE(fix->covariance);
}

TEST(GpsdReport, SurvivesDamage) {
  std::mt19937 chance(52);
  GpsdReports reports;
  for (int i = 0; i < 20000; ++i) {
    std::string line = kTpv;
    for (int k = 0; k < 3; ++k) {
      line[chance() % line.size()] = static_cast<char>(chance() % 256);
    }
    line.resize(chance() % (line.size() + 1));
    reports.take(line, kReceived);
  }
}

}  // namespace
}  // namespace adit
