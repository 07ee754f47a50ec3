// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_evaluate.hpp"

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

/// A circle of 20 m radius, once around, with an offset that grows.
std::string circle(double drift) {
  std::string text;
  for (int i = 0; i < 120; ++i) {
    const double angle = 0.05 * i;
    text += std::to_string(100.0 + 0.1 * i) + " " +
            std::to_string(20.0 * std::cos(angle) + drift * i) + " " +
            std::to_string(20.0 * std::sin(angle)) + " 0 0 0 " +
            std::to_string(std::sin(angle / 2)) + " " + std::to_string(std::cos(angle / 2)) + "\n";
  }
  return text;
}

class CommandEvaluate : public testing::Test {
 protected:
  CommandEvaluate() {
    options_.estimates = {folder_.write("estimate.tum", circle(0.01))};
    options_.truth = folder_.write("truth.tum", circle(0.0));
  }

  int run() { return evaluate_command(options_, out_, err_); }

  /// Runs the sub-command of a program with these arguments: its exit code, or what the command
  /// line's reading ended with.
  static int parse(const std::vector<std::string>& arguments) {
    int code = -1;
    const CommandLine line("adit", "");
    add_evaluate_command(line.program(), [&](int result) { code = result; });
    std::vector<const char*> words = {"adit"};
    for (const std::string& argument : arguments) {
      words.push_back(argument.c_str());
    }
    return line.run(static_cast<int>(words.size()), words.data()).value_or(code);
  }

  test::TemporaryFolder folder_;
  EvaluateCommandOptions options_;
  std::ostringstream out_;
  std::ostringstream err_;
};

TEST_F(CommandEvaluate, TableSaysAssociationCoverageAndAlignment) {
  EXPECT_EQ(run(), 0);
  const std::string report = out_.str();
  for (const char* part :
       {"120 pairs by time", "120 of 120 poses of the estimate", "100.0 %", "SE(3) Umeyama",
        "position (m)", "rotation (deg)", "consecutive pairs 10 m apart", "KITTI segments"}) {
    EXPECT_NE(report.find(part), std::string::npos) << part << "\n" << report;
  }
  EXPECT_EQ(err_.str(), "");
}

TEST_F(CommandEvaluate, JsonHoldsTheSameFigures) {
  options_.json = true;
  EXPECT_EQ(run(), 0);
  const nlohmann::json report = nlohmann::json::parse(out_.str());
  const Evaluation direct =
      evaluate(read_trajectory(options_.estimates[0]), read_trajectory(options_.truth), {});
  EXPECT_EQ(report["ate"]["position_m"]["rmse"].get<double>(), direct.ate.rmse);
  EXPECT_EQ(report["rpe"]["translation_m"]["count"].get<std::size_t>(),
            direct.rpe.translation.count);
  EXPECT_EQ(report["association"]["method"], "time");
  EXPECT_EQ(report["alignment"]["method"], "se3");
  EXPECT_TRUE(report["kitti_segments"]["by_length"].is_array());
}

TEST_F(CommandEvaluate, JsonOfAShortPathHasNulls) {
  options_.json = true;
  options_.evaluation.rpe.delta = 1000.0;
  EXPECT_EQ(run(), 0);
  EXPECT_TRUE(nlohmann::json::parse(out_.str())["rpe"]["translation_m"].is_null());
}

/// Along x, or along a bow, with errors of some centimetres and an attitude that is off by a
/// degree.
std::string drive(double bow, double error) {
  std::string text;
  for (int i = 0; i < 120; ++i) {
    const double x = 0.5 * i;
    const double y = bow * std::sin(0.05 * i) + error * std::sin(1.7 * i);
    text += std::to_string(100.0 + 0.1 * i) + " " + std::to_string(x) + " " + std::to_string(y) +
            " " + std::to_string(error * std::cos(2.3 * i)) + " 0 0 0 1\n";
  }
  return text;
}

TEST_F(CommandEvaluate, AStraightPathSaysThatItsRotationIsFree) {
  options_.estimates = {folder_.write("straight.tum", drive(0.0, 0.05))};
  options_.truth = folder_.write("straight_truth.tum", drive(0.05, 0.0));
  EXPECT_EQ(run(), 0);
  EXPECT_NE(out_.str().find("the path is nearly straight"), std::string::npos) << out_.str();
  EXPECT_NE(out_.str().find("rotation (deg), free"), std::string::npos) << out_.str();
  out_.str("");
  options_.json = true;
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(nlohmann::json::parse(out_.str())["ate"]["rotation_determined"], false);
  out_.str("");
  options_.estimates = {folder_.write("bow.tum", drive(10.0, 0.05))};
  options_.truth = folder_.write("bow_truth.tum", drive(10.0, 0.0));
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(nlohmann::json::parse(out_.str())["ate"]["rotation_determined"], true);
  out_.str("");
  options_.estimates = {folder_ / "straight.tum"};
  options_.truth = folder_ / "straight_truth.tum";
  options_.evaluation.alignment = Alignment::origin;
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(nlohmann::json::parse(out_.str())["ate"]["rotation_determined"], true)
      << "aligned by the first pose, its rotation is what it is";
}

TEST_F(CommandEvaluate, OnlyTheFolderOfARunDoesWithoutATruth) {
  EXPECT_EQ(parse({"evaluate", options_.estimates[0].string()}), 2);
  EXPECT_EQ(parse({"evaluate", options_.estimates[0].string(), options_.truth.string(), "--html",
                   (folder_ / "a.html").string()}),
            2);
}

TEST_F(CommandEvaluate, PlotIsAnSvgWithBothPaths) {
  options_.plot = folder_ / "plot.svg";
  EXPECT_EQ(run(), 0);
  const std::string svg = read_text_file(folder_ / "plot.svg");
  EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  for (const char* part : {"estimate.tum against truth.tum", "x (m)", "y (m)", "position error (",
                           "<polyline", "start", "rmse"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST_F(CommandEvaluate, BadInputIsCodeOneWithTheFileAndNoReport) {
  options_.estimates = {folder_.write("bad.tum", "1 2 3\n")};
  EXPECT_EQ(run(), 1);
  EXPECT_EQ(out_.str(), "");
  EXPECT_NE(err_.str().find("bad.tum, line 1"), std::string::npos) << err_.str();
}

TEST_F(CommandEvaluate, PlotThatCannotBeWrittenIsCodeOne) {
  options_.plot = folder_ / "missing/plot.svg";
  EXPECT_EQ(run(), 1);
  EXPECT_NE(err_.str().find("missing/plot.svg"), std::string::npos);
  EXPECT_NE(out_.str(), "");  // the report was made and is kept
}

TEST_F(CommandEvaluate, OutputThatCannotBeWrittenIsCodeOne) {
  out_.setstate(std::ios::badbit);
  EXPECT_EQ(run(), 1);
}

TEST_F(CommandEvaluate, OptionsReachTheEvaluation) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(parse({"evaluate", options_.estimates[0].string(), options_.truth.string(), "--json",
                   "--align", "origin", "--delta", "3", "--delta-unit", "f", "--pairs", "truth",
                   "--tolerance", "0.02", "--from-first-pose"}),
            0);
  const nlohmann::json report = nlohmann::json::parse(testing::internal::GetCapturedStdout());
  EXPECT_EQ(report["alignment"]["method"], "origin");
  EXPECT_EQ(report["rpe"]["delta"], 3.0);
  EXPECT_EQ(report["rpe"]["delta_unit"], "f");
  EXPECT_EQ(report["rpe"]["pairs_from"], "truth");
  EXPECT_EQ(report["rpe"]["from_first_pose"], true);
  EXPECT_EQ(report["association"]["tolerance_s"], 0.02);
}

TEST_F(CommandEvaluate, FramesDefaultToOne) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(parse({"evaluate", options_.estimates[0].string(), options_.truth.string(), "--json",
                   "--delta-unit", "f"}),
            0);
  EXPECT_EQ(nlohmann::json::parse(testing::internal::GetCapturedStdout())["rpe"]["delta"], 1.0);
}

TEST_F(CommandEvaluate, UsageErrorsDoNotRun) {
  EXPECT_EQ(parse({"evaluate", "a"}), 2);
  EXPECT_EQ(parse({"evaluate", "a", "b", "--align", "best"}), 2);
  EXPECT_EQ(parse({"evaluate", "a", "b", "--delta", "0"}), 2);
  EXPECT_EQ(parse({"evaluate", "a", "b", "--delta", "1.5", "--delta-unit", "f"}), 2);
  EXPECT_EQ(parse({"evaluate", "a", "b", "--tolerance", "-1"}), 2);
}

TEST_F(CommandEvaluate, TheWorldHasToLieSomewhere) {
  for (const auto& [world, part] :
       {std::pair(std::vector<double>{std::nan(""), 11, 500}, "its latitude is nan"),
        std::pair(std::vector<double>{91, 11, 500}, "its latitude is 91"),
        std::pair(std::vector<double>{48, 181, 500}, "its longitude is 181"),
        std::pair(std::vector<double>{48, 11, std::nan("")}, "its height is nan")}) {
    options_.world = world;
    err_.str("");
    EXPECT_EQ(run(), 2);
    EXPECT_NE(err_.str().find(std::string("--world: ") + part), std::string::npos) << err_.str();
  }
}

TEST_F(CommandEvaluate, MissingFilesAreErrorsOfTheData) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(parse({"evaluate", "nowhere.tum", options_.truth.string()}), 1);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("nowhere.tum"), std::string::npos);
}

}  // namespace
}  // namespace adit
