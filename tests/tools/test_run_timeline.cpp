// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_timeline.hpp"

#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

TimelineSpan span(TimelineLane lane, std::size_t sweep, int begin_us, int end_us,
                  bool waits = false) {
  const std::chrono::steady_clock::time_point start{std::chrono::hours(7)};
  return {.lane = lane,
          .sweep = sweep,
          .span = {start + std::chrono::microseconds(begin_us),
                   start + std::chrono::microseconds(end_us)},
          .waits = waits};
}

/// Twenty sweeps, 10 ms each but for one of 30 ms; the reader is busy for 8 of them.
RunTimeline twenty_sweeps() {
  RunTimeline timeline;
  int at = 0;
  for (std::size_t sweep = 100; sweep < 120; ++sweep) {
    const int end = at + (sweep == 117 ? 30'000 : 10'000);
    timeline.add(span(TimelineLane::reader, sweep + 1, at, at + 8000));
    timeline.add(span(TimelineLane::host, sweep, at, at + 1000, true));
    timeline.add(span(TimelineLane::host, sweep, at + 1000, at + 3000));
    timeline.add(span(TimelineLane::device, sweep, at + 3000, end - 1000));
    timeline.add(span(TimelineLane::write, sweep, end - 1000, end));
    at = end;
  }
  return timeline;
}

TEST(RunTimeline, JsonHasLanesByNameAndTimesFromTheFirstOn) {
  const auto events = nlohmann::json::parse(twenty_sweeps().to_json())["traceEvents"];
  ASSERT_EQ(events.size(), 5U + 100U);
  EXPECT_EQ(events[0]["name"], "thread_name");
  EXPECT_EQ(events[0]["args"]["name"], "reader");
  EXPECT_EQ(events[5], (nlohmann::json{{"name", "reader"},
                                       {"ph", "X"},
                                       {"pid", 0},
                                       {"tid", 0},
                                       {"ts", 0.0},
                                       {"dur", 8000.0},
                                       {"args", {{"sweep", 101}}}}));
  EXPECT_EQ(events[6]["name"], "waits");
  EXPECT_EQ(events.back()["ts"], 219'000.0);
}

TEST(RunTimeline, PageTellsHowBusyLanesWereAndDrawsTheSlowest) {
  const std::string page = twenty_sweeps().to_html("Timeline of <drive>");
  for (const char* part :
       {"Timeline of &lt;drive&gt;", "20 sweeps in 0.2 s",
        "<td>reader</td><td>8.00</td><td>73 %</td>", "<td>host</td><td>2.00</td><td>18 %</td>",
        "<td>map</td><td>0.00</td><td>0 %</td>", "The middle: about sweep 110",
        "The slowest: about sweep 117"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
}

TEST(RunTimeline, WithoutASweepThePageSaysSo) {
  EXPECT_NE(RunTimeline().to_html("none").find("No sweep was placed"), std::string::npos);
  EXPECT_NO_THROW(nlohmann::json::parse(RunTimeline().to_json()));
}

TEST(RunTimeline, KeepsSoManySpansAndNoneThatIsTooShort) {
  RunTimeline timeline(2);
  timeline.add(span(TimelineLane::host, 0, 0, 9));
  for (std::size_t sweep = 0; sweep < 3; ++sweep) {
    timeline.add(span(TimelineLane::host, sweep, 0, 10));
  }
  ASSERT_EQ(timeline.spans().size(), 2U);
  EXPECT_EQ(timeline.spans().back().sweep, 1U);
}

TEST(RunTimeline, NamesThatSayNoFormatAndFullDisksAreErrors) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(require_timeline_name("timeline.svg"), UsageError);
  EXPECT_NO_THROW(require_timeline_name("timeline.html"));
  EXPECT_NO_THROW(require_timeline_name("timeline.json"));
  std::filesystem::create_symlink("/dev/full", folder / "full.json");
  EXPECT_THROW(write_timeline(twenty_sweeps(), folder / "full.json", ""), OutputError);
}

}  // namespace
}  // namespace adit
