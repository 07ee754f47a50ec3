// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_plots.hpp"

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/results/sweep_table.hpp"

namespace adit {
namespace {

constexpr ViewSpan kTenThousandSeconds{.first = Nanoseconds(0),
                                       .last = Nanoseconds(10'000'000'000'000)};

class ViewPlotsTest : public testing::Test {
 protected:
  /// So many sweeps, evenly over the span; overlaps are 0.9 but for one of 0.1.
  void write_sweeps(std::size_t count, std::size_t bad) {
    SweepTableWriter table(folder_ / "sweeps.csv");
    for (std::size_t i = 0; i < count; ++i) {
      SweepRecord sweep;
      sweep.index = static_cast<double>(i);
      sweep.stamp = nanoseconds(10'000.0 * static_cast<double>(i) / static_cast<double>(count - 1));
      sweep.overlap = i == bad ? 0.1 : 0.9;
      table.write(sweep);
    }
    table.close();
  }

  test::TemporaryFolder folder_;
  std::ostringstream progress_;
};

TEST_F(ViewPlotsTest, LongRunsAreThinnedAndKeepTheirExtremes) {
  write_sweeps(5000, 2500);
  const nlohmann::ordered_json plots =
      run_of(folder_.path(), kTenThousandSeconds, {}, progress_).plots;
  ASSERT_EQ(plots.at("curves").size(), 1U) << "only what is known";
  const nlohmann::ordered_json& overlap = plots.at("curves").at(0);
  EXPECT_EQ(overlap.at("name"), "overlap");
  ASSERT_EQ(overlap.at("least").size(), kMostPlotBins);
  EXPECT_EQ(overlap.at("least").at(512), 0.1);
  EXPECT_EQ(overlap.at("most").at(512), 0.9);
  EXPECT_EQ(overlap.at("least").at(511), 0.9);
}

TEST_F(ViewPlotsTest, StretchesCountFromTheScenesBegin) {
  write_sweeps(10, 10);
  std::ofstream(folder_ / "summary.json")
      << R"({"verdict": {"stretches": [{"state": "lost", "begin_s": 2, "end_s": 3.5, "text": "why"},)"
         R"( {"state": 7}, 8]}})";
  const ViewSpan earlier{.first = Nanoseconds(-5'000'000'000), .last = kTenThousandSeconds.last};
  const nlohmann::ordered_json plots = run_of(folder_.path(), earlier, {}, progress_).plots;
  EXPECT_EQ(plots.at("stretches").dump(),
            R"([{"state":"lost","begin":7.0,"end":8.5,"text":"why"}])");
}

TEST_F(ViewPlotsTest, DirectionsThatAreNotHeldAreTold) {
  SweepTableWriter table(folder_ / "sweeps.csv");
  for (int i = 0; i < 3; ++i) {
    SweepRecord sweep;
    sweep.index = i;
    sweep.stamp = nanoseconds(i);
    sweep.translation[0] = {.localizability = i == 0   ? "full"
                                              : i == 1 ? "none"
                                                       : "partial",
                            .axis = Eigen::Vector3d::UnitX()};
    sweep.translation[1] = {.localizability = "full", .axis = Eigen::Vector3d::UnitY()};
    table.write(sweep);
  }
  table.close();
  std::vector<ViewSweep> sweeps;  // the map holds the second one first, and the first not at all
  for (const int second : {1, 2}) {
    sweeps.push_back({.stamp = nanoseconds(second)});
  }
  const ViewRun run = run_of(folder_.path(), kTenThousandSeconds, sweeps, progress_);
  EXPECT_EQ(run.weak.dump(),
            R"({"sweep":[0,1],"axis":[1.0,0.0,0.0,1.0,0.0,0.0],"none":[true,false]})");
}

TEST_F(ViewPlotsTest, WithoutATableOrWithADamagedOneThereAreNone) {
  EXPECT_TRUE(run_of(folder_.path(), kTenThousandSeconds, {}, progress_).plots.is_null());
  EXPECT_EQ(progress_.str(), "");
  std::ofstream(folder_ / "sweeps.csv") << "stamp_s,overlap\n1,0.5\n2,much\n";
  EXPECT_TRUE(run_of(folder_.path(), kTenThousandSeconds, {}, progress_).plots.is_null());
  EXPECT_NE(progress_.str().find("overlap is 'much'"), std::string::npos) << progress_.str();
}

}  // namespace
}  // namespace adit
