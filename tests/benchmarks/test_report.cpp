// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/benchmarks/report_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit::bench {
namespace {

std::string text_of(const Report& report) {
  std::ostringstream out;
  print_head(out);
  for (const Row& row : report.rows) {
    print_row(row, report, out);
  }
  return out.str();
}

TEST(Spread, IsTheTenthMiddleAndNinetiethOfTheRuns) {
  std::vector<double> runs;
  for (int i = 0; i <= 100; ++i) {
    runs.push_back(i * 37 % 101);
  }
  const Spread spread = spread_of(runs);
  EXPECT_EQ(spread.low, 10.0);
  EXPECT_EQ(spread.median, 50.0);
  EXPECT_EQ(spread.high, 90.0);
  EXPECT_EQ(spread_of({4.0}).low, 4.0);
  EXPECT_THROW(spread_of({}), std::invalid_argument);
}

TEST(Bound, IsTheLimitThatTakesLongest) {
  const DeviceLimits limits = test::small_report().limits;
  EXPECT_EQ(bound_of({.bytes = 1e7, .flop = 1e7}, limits).by, "memory");
  EXPECT_DOUBLE_EQ(bound_of({.bytes = 1e7}, limits).ms, 1.0);
  EXPECT_EQ(bound_of({.bytes = 1e7, .flop = 1e9}, limits).by, "arithmetic");
  EXPECT_EQ(bound_of({.bytes = 1e3, .reads = 1e5}, limits).by, "reads");
  EXPECT_EQ(bound_of({.reads = 1e5, .atomics = 1e6}, limits).by, "atomics");
  EXPECT_EQ(bound_of({.bytes = 1e3, .dispatches = 3.0}, limits).by, "dispatches");
  EXPECT_DOUBLE_EQ(bound_of({.dispatches = 3.0}, limits).ms, 0.15);
}

TEST(Measure, CountsRunsAndUndoesEach) {
  int runs = 0;
  int undone = 0;
  const Work work{.run =
                      [&] {
                        runs += 1;
                        return Sample{.device_ms = 2.0, .wait_ms = {}, .host_ms = 3.0};
                      },
                  .undo = [&] { undone += 1; }};
  const Timing timing = measure(work, {.seconds = 0.0, .least_runs = 7, .most_runs = 100});
  EXPECT_EQ(timing.runs, 7);
  EXPECT_EQ(runs, 8) << "the first is not counted: drivers compile then";
  EXPECT_EQ(undone, runs);
  ASSERT_TRUE(timing.device.has_value());
  EXPECT_EQ(timing.device->median, 2.0);
  EXPECT_FALSE(timing.wait.has_value());
  EXPECT_EQ(timing.host.median, 3.0);
  EXPECT_EQ(measure(work, {.seconds = 60.0, .least_runs = 1, .most_runs = 4}).runs, 4);
}

TEST(Report, ComesBackFromJsonAsItWas) {
  const test::TemporaryFolder folder;
  const Report report = test::small_report();
  const std::string written = to_json(report).dump(1);
  write_text_file(folder.path() / "a.json", written);
  EXPECT_EQ(to_json(read_report(folder.path() / "a.json")).dump(1), written);
}

TEST(Report, SaysWhatIsWrongWithAFile) {
  const test::TemporaryFolder folder;
  const auto complaint = [&](const std::string& content) -> std::string {
    write_text_file(folder.path() / "a.json", content);
    try {
      read_report(folder.path() / "a.json");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint("{}").find("adit bench --json"), std::string::npos);
  EXPECT_NE(complaint("not JSON").find("a.json"), std::string::npos);
  EXPECT_NE(complaint(R"({"schema": "bench/99"})").find("expected bench/1"), std::string::npos);
  std::string written = to_json(test::small_report()).dump(1);
  EXPECT_NE(complaint(written.substr(0, written.size() / 2)), "");
  written.replace(written.find("\"peer\","), 7, "\"pear\",");
  EXPECT_NE(complaint(written), "");
  EXPECT_THROW(read_report(folder.path() / "none.json"), InputError);
}

TEST(Report, PrintsALineARow) {
  const std::string text = text_of(test::small_report());
  EXPECT_EQ(std::ranges::count(text, '\n'), 6);
  EXPECT_NE(text.find("10.0 % memory"), std::string::npos) << text;
  EXPECT_NE(text.find("0.250  error mm 0.250, voxels 12"), std::string::npos) << text;
  EXPECT_NE(text.find("WRONG, not timed: differs"), std::string::npos) << text;
}

TEST(Report, ComparesWhatBothHave) {
  const Report before = test::small_report();
  Report after = before;
  for (double* value : {&after.rows[1].timing.device->low, &after.rows[1].timing.device->median,
                        &after.rows[1].timing.device->high}) {
    *value *= 0.5;
  }
  after.rows.push_back(after.rows[1]);
  after.rows.back().name = "new";
  std::ostringstream out;
  print_comparison(before, after, out);
  const std::string text = out.str();
  EXPECT_NE(text.find("0.500  faster"), std::string::npos) << text;
  EXPECT_EQ(text.find("slower\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("new"), std::string::npos);
  EXPECT_EQ(text.find("broken"), std::string::npos);
}

TEST(Report, ComparesByHowFastTheMachineWas) {
  const Report before = test::small_report();
  Report after = before;
  after.limits.copy_bytes *= 0.5;
  for (double* value : {&after.rows[1].timing.device->low, &after.rows[1].timing.device->median,
                        &after.rows[1].timing.device->high}) {
    *value *= 2.0;
  }
  std::ostringstream slower_machine;
  print_comparison(before, after, slower_machine);
  EXPECT_NE(slower_machine.str().find("2.00       1.00\n"), std::string::npos)
      << slower_machine.str();
  after.limits_moved = {1.3, "memory"};
  after.rows[1].timing = before.rows[1].timing;
  std::ostringstream disturbed;
  print_comparison(before, after, disturbed);
  EXPECT_NE(disturbed.str().find("disturbed"), std::string::npos);
  EXPECT_EQ(disturbed.str().find("  faster\n"), std::string::npos) << disturbed.str();
}

TEST(Limits, OfTwoMeasurementsTheBetterCountsAndHowFarTheyLieApart) {
  const DeviceLimits a = test::small_report().limits;
  DeviceLimits b = a;
  b.flop *= 0.5;
  b.atomics *= 1.5;
  b.dispatch_s *= 2.0;
  const DeviceLimits best = best_of(a, b);
  EXPECT_EQ(best.flop, a.flop);
  EXPECT_EQ(best.atomics, b.atomics);
  EXPECT_EQ(best.dispatch_s, a.dispatch_s);
  EXPECT_EQ(moved(a, b).which, "arithmetic");
  EXPECT_DOUBLE_EQ(moved(a, b).ratio, 2.0);
  EXPECT_DOUBLE_EQ(moved(a, a).ratio, 1.0);
  Report report = test::small_report();
  EXPECT_TRUE(limits_hold(report));
  report.limits_moved = moved(a, b);
  EXPECT_FALSE(limits_hold(report));
  std::ostringstream out;
  print_limits(report, out);
  EXPECT_NE(out.str().find("arithmetic moved most, by 100 %"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("void"), std::string::npos) << out.str();
}

TEST(Report, PageStandsAlone) {
  const std::string page = to_html(test::small_report());
  EXPECT_NE(page.find("a &lt;device&gt;"), std::string::npos);
  EXPECT_EQ(page.find("a <device>"), std::string::npos);
  for (const char* outside : {"<script", "src=", "<link", "href="}) {
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  }
  EXPECT_NE(page.find("10 % of memory"), std::string::npos);
  EXPECT_NE(page.find("wrong, not timed: differs"), std::string::npos);
  size_t drawings = 0;
  for (size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1)) {
    drawings += 1;
  }
  EXPECT_EQ(drawings, 8U) << "roofline, kernels, batches, peers; nothing of whole registrations; "
                             "each for a desktop and for a telephone";
  EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
  EXPECT_NE(page.find("name=\"viewport\""), std::string::npos);
}

}  // namespace
}  // namespace adit::bench
