// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Several estimates beside one truth, in one table and one picture.
#include "adit/tools/evaluation/comparison.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_evaluate.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

using test::count;

/// Along a bow, with an error that swings by `error` (m).
std::string bow(double error, double first_time = 100.0) {
  std::string text;
  for (int i = 0; i < 200; ++i) {
    const double x = 0.5 * i;
    text += std::to_string(first_time + 0.1 * i) + " " + std::to_string(x) + " " +
            std::to_string(10.0 * std::sin(0.05 * i) + error * std::sin(0.7 * i)) + " 0 0 0 0 1\n";
  }
  return text;
}

class CompareEstimates : public testing::Test {
 protected:
  CompareEstimates() {
    fs::create_directories(folder_ / "a_system");
    fs::create_directories(folder_ / "b");
    options_.estimates = {folder_.write("a_system/out.tum", bow(0.02)),
                          folder_.write("b/out.tum", bow(0.2))};
    options_.truth = folder_.write("truth.tum", bow(0.0));
  }

  int run() {
    out_.str("");
    err_.str("");
    return evaluate_command(options_, out_, err_);
  }

  test::TemporaryFolder folder_;
  EvaluateCommandOptions options_;
  std::ostringstream out_;
  std::ostringstream err_;
};

TEST_F(CompareEstimates, EachHasALineAndTheLeastIsMarked) {
  EXPECT_EQ(run(), 0) << err_.str();
  EXPECT_NE(out_.str().find("a_system/out.tum"), std::string::npos) << out_.str();
  EXPECT_NE(out_.str().find("b/out.tum"), std::string::npos) << out_.str();
  EXPECT_NE(out_.str().find("*0.014"), std::string::npos) << out_.str();
  EXPECT_EQ(out_.str().find("*0.14"), std::string::npos) << out_.str();
}

TEST_F(CompareEstimates, TablesForPapersAndPrograms) {
  options_.table = TableFormat::markdown;
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(test::count(out_.str(), "\n"), 4U) << out_.str();
  EXPECT_NE(out_.str().find("| a_system/out.tum | 200 | 100.0 | **0.014** |"), std::string::npos)
      << out_.str();
  options_.table = TableFormat::latex;
  EXPECT_EQ(run(), 0);
  EXPECT_NE(out_.str().find("a\\_system/out.tum & 200 & 100.0 & \\textbf{0.014} &"),
            std::string::npos)
      << out_.str();
  EXPECT_NE(out_.str().find("KITTI (\\%)"), std::string::npos) << out_.str();
  options_.table = TableFormat::csv;
  EXPECT_EQ(run(), 0);
  EXPECT_TRUE(out_.str().starts_with("estimate,poses,covered_percent,ate_rmse_m,")) << out_.str();
  EXPECT_EQ(count(out_.str(), "\n"), 3U);
  EXPECT_EQ(count(out_.str(), "*"), 0U);
  options_.json = true;
  EXPECT_EQ(run(), 0);
  const nlohmann::json json = nlohmann::json::parse(out_.str());
  EXPECT_EQ(json["estimates"].size(), 2U);
  EXPECT_NEAR(json["estimates"][1]["ate"]["position_m"]["rmse"].get<double>(), 0.14, 0.01);
}

TEST_F(CompareEstimates, OneEstimateHasNothingMarked) {
  options_.estimates.pop_back();
  options_.table = TableFormat::markdown;
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(out_.str().find("**"), std::string::npos) << out_.str();
}

TEST_F(CompareEstimates, OneThatCannotBeComparedIsNotedAndTheOthersAreThere) {
  options_.estimates.push_back(folder_.write("late.tum", bow(0.0, 9000.0)));
  EXPECT_EQ(run(), 1);
  EXPECT_NE(out_.str().find("*0.014"), std::string::npos) << out_.str();
  EXPECT_NE(err_.str().find("late.tum: "), std::string::npos) << err_.str();
}

TEST_F(CompareEstimates, RunThatDidNotCompleteIsNoted) {
  fs::create_directories(folder_ / "run");
  folder_.write("run/trajectory.tum", bow(0.01));
  folder_.write("run/summary.json",
                R"({"adit": "0", "status": "interrupted", "reason": "stopped"})");
  options_.estimates.push_back(folder_ / "run");
  EXPECT_EQ(run(), 0) << err_.str();
  EXPECT_NE(err_.str().find("run: NOT COMPLETE"), std::string::npos) << err_.str();
}

TEST_F(CompareEstimates, OnePictureHasACurveOfEach) {
  options_.plot = folder_ / "all.svg";
  EXPECT_EQ(run(), 0) << err_.str();
  const std::string svg = test::content(folder_ / "all.svg");
  EXPECT_EQ(count(svg, "<polyline"), 5U) << "two from above, the truth, and two errors";
  EXPECT_EQ(count(svg, ">a_system/out.tum<"), 1U);
  options_.plot = folder_ / "all.html";
  EXPECT_EQ(run(), 0) << err_.str();
  EXPECT_TRUE(test::content(folder_ / "all.html").starts_with("<!DOCTYPE html>"));
}

TEST_F(CompareEstimates, PictureIsWhatItsNameSays) {
  for (const char* name : {"x.png", "x.pdf", "x"}) {
    options_.plot = folder_ / name;
    EXPECT_EQ(run(), 2);
    EXPECT_NE(err_.str().find("NAME.svg, or as a page NAME.html"), std::string::npos) << err_.str();
    EXPECT_FALSE(fs::exists(folder_ / name));
    EXPECT_EQ(out_.str(), "") << "before any work";
  }
}

TEST(ShortNames, AreTheShortestThatDiffer) {
  EXPECT_EQ(short_names({"x/a.tum", "y/b.tum"}), (std::vector<std::string>{"a.tum", "b.tum"}));
  EXPECT_EQ(short_names({"x/a.tum", "y/a.tum"}), (std::vector<std::string>{"x/a.tum", "y/a.tum"}));
  EXPECT_EQ(short_names({"out/", "other"}), (std::vector<std::string>{"out", "other"}));
  EXPECT_EQ(short_names({"a", "a"}).size(), 2U);
}

}  // namespace
}  // namespace adit
