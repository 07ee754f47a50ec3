// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/run_review.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_evaluate.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/evaluation/run_page.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using test::count;

/// 100 sweeps, a tenth of a second apart. From sweep 40 to 59 nothing holds the movement along x;
/// sweep 70 coasts; innovations are as large as they should be, but one beyond the gate.
std::vector<SweepRecord> corridor() {
  std::vector<SweepRecord> sweeps;
  for (int i = 0; i < 100; ++i) {
    SweepRecord sweep;
    sweep.index = i;
    sweep.stamp = std::chrono::seconds(1'700'000'000) + std::chrono::milliseconds(100 * i);
    sweep.state = i == 0 ? "initializing" : i == 70 ? "coasting" : "tracking";
    sweep.imu = i < 10 ? "starting" : "fused";
    sweep.overlap = 0.9;
    const bool weak = i >= 40 && i < 60;
    for (std::size_t k = 0; k < 3; ++k) {
      sweep.translation[k] = {
          .localizability = weak && k == 0 ? "none" : "full",
          .support = 100.0,
          .sigma = 0.01,
          .axis = (i % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(k))};
      sweep.rotation[k] = sweep.translation[k];
      sweep.rotation[k].localizability = "full";
    }
    if (i >= 10) {
      sweep.gyro_bias = {0.01, -0.02, 0.003};
      sweep.gyro_bias_sigma = Eigen::Vector3d::Constant(1e-3);
      sweep.accel_bias = {0.1, 0.0, -0.1};
      sweep.accel_bias_sigma = Eigen::Vector3d::Constant(0.02);
      sweep.gravity = 9.81 * Eigen::Vector3d(0.01, 0.0, -1.0).normalized();
      sweep.gravity_sigma = 1e-3;
      sweep.innovation_squared = i == 50 ? 1000.0 : 6.0;
      sweep.innovation_degrees = 6.0;
      sweep.innovation_gate = 224.6;
    }
    sweeps.push_back(sweep);
  }
  return sweeps;
}

class RunFolder : public testing::Test {
 protected:
  RunFolder() {
    SweepTableWriter table(folder_ / "sweeps.csv");
    std::vector<StampedPose> poses;
    for (const SweepRecord& sweep : corridor()) {
      table.write(sweep);
      StampedPose pose{.stamp = sweep.stamp};
      pose.pose.translation() << 0.1 * sweep.index, 0.002 * sweep.index * sweep.index, 0.0;
      poses.push_back(pose);
    }
    table.close();
    write_trajectory(folder_ / "trajectory.tum", TrajectoryFormat::tum, poses);
    write_trajectory(folder_ / "truth.tum", TrajectoryFormat::tum, poses);
    folder_.write("summary.json", R"({"configuration": {"registration": {"min_overlap": 0.3}}})");
  }

  test::TemporaryFolder folder_;
};

TEST_F(RunFolder, NamesStretchesThatNothingHolds) {
  const RunReview review = review_run(folder_.path());
  ASSERT_EQ(review.weak.size(), 1U);
  const WeakStretch& weak = review.weak[0];
  EXPECT_NEAR(weak.begin, 4.0, 1e-9);
  EXPECT_NEAR(weak.end, 5.9, 1e-9);
  EXPECT_EQ(weak.sweeps, 20U);
  EXPECT_EQ(weak.unheld, 20U);
  EXPECT_FALSE(weak.rotation);
  EXPECT_NEAR(std::abs(weak.axis.x()), 1.0, 1e-9) << "signs of axes mean nothing";
  const std::string text = describe(review);
  EXPECT_NE(text.find("4.0 to 5.9 s, moving along (1.00, 0.00, 0.00) of the map: 20 sweeps, 20 of "
                      "them by no match"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("1 initializing, 98 tracking, 1 coasting"), std::string::npos) << text;
}

TEST_F(RunFolder, ComparesInnovationsWithTheirBounds) {
  const InnovationReview found = review_run(folder_.path()).innovations;
  EXPECT_EQ(found.count, 90U);
  EXPECT_NEAR(found.per_degree, (89.0 * 6.0 + 1000.0) / (90.0 * 6.0), 1e-9);
  EXPECT_NEAR(found.beyond_95, 1.0 / 90.0, 1e-12);
  EXPECT_EQ(found.beyond_gate, 1U);
}

TEST_F(RunFolder, TellsBiasesAndTilt) {
  const RunReview review = review_run(folder_.path());
  EXPECT_NEAR(tilt_of(review.sweeps.back()), std::atan(0.01), 1e-9);
  EXPECT_NE(describe(review).find("0.57 degrees (+- 0.06) off the map's -z"), std::string::npos)
      << describe(review);
  EXPECT_EQ(to_json(review)["gyro_bias_rad_per_s"][1], -0.02);
  EXPECT_EQ(review.min_overlap, 0.3);
}

TEST_F(RunFolder, IsEvaluatedWithAndWithoutATruth) {
  EvaluateCommandOptions options;
  options.estimates = {folder_.path()};
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(evaluate_command(options, out, err), 0) << err.str();
  EXPECT_NE(out.str().find("weakly held"), std::string::npos);
  EXPECT_EQ(out.str().find("ATE"), std::string::npos);
  const std::string alone = test::content(folder_ / "evaluation.html");
  EXPECT_EQ(count(alone, "<svg"), 2U) << "for a desktop and for a telephone";
  options.truth = folder_ / "truth.tum";
  options.html = folder_ / "page.html";
  options.json = true;
  out.str("");
  EXPECT_EQ(evaluate_command(options, out, err), 0) << err.str();
  const nlohmann::json json = nlohmann::json::parse(out.str());
  EXPECT_LT(json["ate"]["position_m"]["rmse"].get<double>(), 1e-6);
  EXPECT_EQ(json["run"]["weakly_held"].size(), 1U);
  EXPECT_EQ(count(test::content(folder_ / "page.html"), "<svg"), 4U);
}

TEST_F(RunFolder, ThePageDrawsEveryQuantityItsGatesAndNothingThatIsNoNumber) {
  const RunReview review = review_run(folder_.path());
  const std::string page = run_page("out", describe(review), review, nullptr);
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_EQ(count(page, "src="), 0U);
  EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
  for (const char* part : {"Bias of the gyroscope (mrad/s", "Bias of the accelerometer (m/s^2",
                           "Gravity off the map", "Innovation, squared and normalised", ">gate<",
                           "95 % of chi squared", "registration.min_overlap",
                           "Directions held by matches", "time since the first sweep (s)"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(count(page, "Velocity (m/s"), 0U) << "there is none in this table";
  for (const char* bad : {"nan", "inf"}) {
    EXPECT_EQ(count(page, std::string("=\"") + bad), 0U) << bad;
    EXPECT_EQ(count(page, std::string(",") + bad), 0U) << bad;
  }
}

TEST_F(RunFolder, IsInspectedWithoutATruth) {
  InspectCommandOptions options;
  options.recording = folder_.path();
  options.html = folder_ / "run.html";
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(inspect_command(options, out, err), 0) << err.str();
  const RunReview review = review_run(folder_.path());
  EXPECT_EQ(out.str(), describe(review));
  EXPECT_EQ(test::content(folder_ / "run.html"),
            run_page(folder_.path().string(), describe(review), review, nullptr));
  options.json = true;
  out.str("");
  EXPECT_EQ(inspect_command(options, out, err), 0) << err.str();
  nlohmann::ordered_json printed = nlohmann::ordered_json::parse(out.str());
  EXPECT_EQ(printed.front(), "inspect/1");
  printed.erase("schema");
  EXPECT_EQ(printed, to_json(review));
  options.write_config = folder_ / "drive.toml";
  EXPECT_EQ(inspect_command(options, out, err), 2);
  EXPECT_NE(err.str().find("--write-config needs a recording"), std::string::npos) << err.str();
}

TEST_F(RunFolder, SaysThatItsRunWasKilledOrStopped) {
  InspectCommandOptions inspect;
  inspect.recording = folder_.path();
  EvaluateCommandOptions evaluate;
  evaluate.estimates = {folder_.path()};
  const auto said_by_both = [&](const std::string& summary) {
    folder_.write("summary.json", summary);
    std::ostringstream inspected;
    std::ostringstream evaluated;
    std::ostringstream err;
    EXPECT_EQ(inspect_command(inspect, inspected, err), 0) << err.str();
    EXPECT_EQ(evaluate_command(evaluate, evaluated, err), 0) << err.str();
    const auto first_line = [](const std::string& text) { return text.substr(0, text.find('\n')); };
    EXPECT_EQ(first_line(inspected.str()), first_line(evaluated.str()));
    EXPECT_NE(test::content(folder_ / "evaluation.html").find(first_line(evaluated.str())),
              std::string::npos);
    return first_line(inspected.str());
  };
  EXPECT_EQ(said_by_both(R"({"adit": "0", "status": "running", "input": {"count": 300}})"),
            "run          NOT COMPLETE, it was killed, or is still going on; 100 of 300 sweeps are "
            "here");
  EXPECT_EQ(
      said_by_both(R"({"adit": "0", "status": "interrupted", "reason": "stopped"})"),
      "run          NOT COMPLETE, it ended early (interrupted): stopped; 100 sweeps are here");
  EXPECT_EQ(said_by_both(R"({"adit": "0", "status": "completed", "input": {"count": 100}})"),
            "run          completed, 100 of 100 sweeps");
  const RunReview review = review_run(folder_.path());
  EXPECT_EQ(to_json(review)["status"], "completed");
  // Killed in the middle of a line, or before the first.
  folder_.write("summary.json", R"({"adit": "0", "status": "running", "input": {"count": 300}})");
  std::ofstream(folder_ / "sweeps.csv", std::ios::app) << "100,1700000010.0,track";
  EXPECT_EQ(review_run(folder_.path()).sweeps.size(), 100U);
  std::filesystem::remove(folder_ / "sweeps.csv");
  std::ostringstream out;
  EXPECT_EQ(inspect_command(inspect, out, out), 0);
  EXPECT_NE(out.str().find("0 of 300 sweeps are here"), std::string::npos) << out.str();
}

TEST_F(RunFolder, WhatAStoppedRunLacksIsSaidToBeMissingForThat) {
  folder_.write("trajectory.tum", "");
  EvaluateCommandOptions options;
  options.estimates = {folder_.path()};
  options.truth = folder_ / "truth.tum";
  const auto said = [&](const char* status) {
    folder_.write("summary.json", R"({"adit": "0", "reason": "stopped", "status": ")" +
                                      std::string(status) + "\"}");
    std::ostringstream out;
    std::ostringstream err;
    EXPECT_EQ(evaluate_command(options, out, err), 1);
    return err.str();
  };
  const std::string interrupted = said("interrupted");
  EXPECT_NE(interrupted.find("NOT COMPLETE, it ended early (interrupted): stopped; 100 sweeps"),
            std::string::npos)
      << interrupted;
  EXPECT_NE(interrupted.find("it holds no pose"), std::string::npos) << interrupted;
  EXPECT_EQ(said("completed").find("NOT COMPLETE"), std::string::npos);
}

TEST_F(RunFolder, WithoutItsTableIsRefused) {
  std::filesystem::remove(folder_ / "sweeps.csv");
  EXPECT_THROW(review_run(folder_.path()), InputError);
}

}  // namespace
}  // namespace adit
