// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/progress.hpp"

#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace adit {
namespace {

using namespace std::chrono_literals;

std::size_t count(const std::string& text, char letter) {
  return static_cast<std::size_t>(std::ranges::count(text, letter));
}

TEST(Progress, DurationsAreReadAsOnAClock) {
  EXPECT_EQ(format_duration(0.0), "0:00");
  EXPECT_EQ(format_duration(-3.0), "0:00");
  EXPECT_EQ(format_duration(9.6), "0:10");
  EXPECT_EQ(format_duration(61.0), "1:01");
  EXPECT_EQ(format_duration(3725.0), "1:02:05");
}

TEST(Progress, BarShowsShareRateAndTimeLeft) {
  const ProgressState state{.done = 30, .total = 60, .failed = 0, .elapsed_s = 2.0};
  EXPECT_EQ(
      format_bar("map", state, 200),
      "map [====================>                   ]  50 %  30/60 sweeps  15.0/s  0:02 left");
}

TEST(Progress, BarIsFullAtTheEndAndShowsTheTimeTaken) {
  const ProgressState state{.done = 60, .total = 60, .failed = 2, .elapsed_s = 75.0};
  const std::string bar = format_bar("map", state, 200);
  EXPECT_NE(bar.find("[" + std::string(40, '=') + "] 100 %  60/60 sweeps  2 failed  0.80/s  1:15"),
            std::string::npos)
      << bar;
  EXPECT_EQ(bar.find("left"), std::string::npos);
}

TEST(Progress, BarNeverExceedsTheTerminal) {
  const ProgressState state{.done = 12345, .total = 99999, .failed = 17, .elapsed_s = 1000.0};
  for (std::size_t columns = 0; columns < 120; ++columns) {
    EXPECT_LE(format_bar("map", state, columns).size(), columns);
  }
}

TEST(Progress, LineShowsTheSameInWords) {
  const ProgressState state{.done = 27, .total = 60, .failed = 1, .elapsed_s = 2.7};
  EXPECT_EQ(format_line("map", state), "map 27/60 sweeps (45 %), 1 failed, 10.0/s, 0:03 left");
  EXPECT_EQ(format_line("tile", {.done = 10, .total = 100, .elapsed_s = 2.0, .unit = "points"}),
            "tile 10/100 points (10 %), 5.00/s, 0:18 left");
}

TEST(Progress, TimeLeftIsEstimatedFromTenPieces) {
  EXPECT_EQ(format_line("map", {.done = 9, .total = 600, .elapsed_s = 3.0}),
            "map 9/600 sweeps (1 %), 3.00/s");
  EXPECT_NE(format_line("map", {.done = 10, .total = 600, .elapsed_s = 3.0}).find(" left"),
            std::string::npos);
}

TEST(Progress, NothingDoneHasNoRateYet) {
  EXPECT_EQ(format_line("map", {.done = 0, .total = 60, .failed = 0, .elapsed_s = 1.0}),
            "map 0/60 sweeps (0 %)");
}

TEST(Progress, LinesComeEveryTenthWhenWorkIsSlow) {
  std::ostringstream out;
  const Progress::Clock::time_point start;
  Progress progress(out, ProgressStyle::lines, "map", 100, start);
  for (std::size_t i = 1; i <= 100; ++i)
    progress.update(i, 0, start + i * 400ms);  // a tenth is 4 s
  EXPECT_EQ(count(out.str(), '\n'), 10U) << out.str();
  EXPECT_EQ(count(out.str(), '\r'), 0U);
}

TEST(Progress, LinesComeEveryFiveSecondsWhenWorkIsVerySlow) {
  std::ostringstream out;
  const Progress::Clock::time_point start;
  Progress progress(out, ProgressStyle::lines, "map", 1000, start);
  for (std::size_t i = 1; i <= 20; ++i) {
    progress.update(i, 0, start + i * 1s);
  }
  EXPECT_EQ(count(out.str(), '\n'), 4U) << out.str();
}

TEST(Progress, FastWorkPrintsLittleAndItsEnd) {
  std::ostringstream out;
  const Progress::Clock::time_point start;
  Progress progress(out, ProgressStyle::lines, "map", 1000, start);
  for (std::size_t i = 1; i <= 1000; ++i) {
    progress.update(i, 0, start + i * 1ms);
  }
  EXPECT_EQ(out.str(), "map 1000/1000 sweeps (100 %), 1000.0/s, 0:01\n");
}

TEST(Progress, NotesStandAboveTheBarOnLinesOfTheirOwn) {
  std::ostringstream out;
  const Progress::Clock::time_point start;
  Progress progress(out, ProgressStyle::bar, "map", 2, start);
  progress.update(1, 0, start + 1s);
  progress.note("sweep 1 failed");
  progress.update(2, 1, start + 2s);
  progress.finish();
  EXPECT_NE(out.str().find("\r\x1b[Ksweep 1 failed\n\rmap "), std::string::npos);
  EXPECT_EQ(count(out.str(), '\n'), 2U);
  EXPECT_EQ(out.str().back(), '\n');
}

TEST(Progress, QuietPrintsNotesAlone) {
  std::ostringstream out;
  Progress progress(out, ProgressStyle::none, "map", 2);
  progress.update(1, 0);
  progress.note("sweep 1 failed");
  progress.update(2, 1);
  progress.finish();
  EXPECT_EQ(out.str(), "sweep 1 failed\n");
}

}  // namespace
}  // namespace adit
