// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/pose_consistency.hpp"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_evaluate.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

constexpr std::size_t kManySweeps = 4000;
constexpr double kMemory = 0.8825;  // from one error to the next: exp(-0.1 s / 0.8 s)

/// A run on a curve, ten sweeps a second, whose poses err as their covariances say, times `factor`:
/// alike, where they are a moment apart.
/// The truth is given in another frame.
struct Drive {
  RunReview review;
  Trajectory estimate{.file = "estimate.tum", .stamped = true, .poses = {}};
  Trajectory truth{.file = "truth.tum", .stamped = true, .poses = {}};
};

Drive drive(double factor) {
  Random random(1);
  Vector6d sigma;
  sigma << 0.02, 0.03, 0.05, 0.002, 0.001, 0.004;
  const Eigen::Isometry3d T_world_map =
      Eigen::Translation3d(50.0, -20.0, 3.0) * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY());
  Drive result;
  Vector6d error = Vector6d::Zero();
  for (std::size_t i = 0; i < kManySweeps; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    const Nanoseconds stamp = std::chrono::milliseconds(100 * i);
    const Eigen::Isometry3d truth = Eigen::Translation3d(2.0 * t, std::sin(t), 0.1 * t) *
                                    Eigen::AngleAxisd(0.3 * t, Eigen::Vector3d::UnitZ());
    for (Eigen::Index k = 0; i > 0 && k < 6; ++k) {
      const double fresh = factor * sigma[k] * random.gaussian();
      error[k] = kMemory * error[k] + std::sqrt(1.0 - kMemory * kMemory) * fresh;
    }
    SweepRecord record;
    record.stamp = stamp;
    record.state = "tracking";
    record.uncertainty = {};
    record.uncertainty.local.diagonal() = i > 0 ? Vector6d(sigma.cwiseAbs2()) : Vector6d::Zero();
    result.review.sweeps.push_back(record);
    result.review.times.push_back(t);
    result.estimate.poses.push_back({.stamp = stamp, .pose = retract(truth, error)});
    result.truth.poses.push_back({.stamp = stamp, .pose = T_world_map * truth});
  }
  return result;
}

PoseConsistency consistency_of(const Drive& run) {
  return pose_consistency(run.review, run.estimate, run.truth, 0.01).value();
}

TEST(PoseConsistency, IsOneWhereErrorsAreWhatCovariancesSay) {
  const PoseConsistency found = consistency_of(drive(1.0));
  EXPECT_EQ(found.since_first.samples, kManySweeps - 1);
  EXPECT_NEAR(found.since_first.pose, 1.0, 0.12)
      << "three standard deviations of such a mean: 0.09";
  EXPECT_NEAR(found.since_first.translation, 1.0, 0.15);
  EXPECT_NEAR(found.since_first.rotation, 1.0, 0.15);
  EXPECT_EQ(found.second.samples, kManySweeps - 10);
  EXPECT_NEAR(found.second.pose, 1.0, 0.15);
  EXPECT_LT(found.beyond, 0.01);
}

TEST(PoseConsistency, GrowsWithTheSquareOfWhatErrorsExceedTheirCovariancesBy) {
  const PoseConsistency found = consistency_of(drive(3.0));
  EXPECT_NEAR(found.since_first.pose, 9.0, 1.0);
  EXPECT_NEAR(found.second.pose, 9.0, 1.4);
  EXPECT_NEAR(found.beyond, 0.317, 0.04) << "one sigma of theirs is three of what they say";
}

TEST(PoseConsistency, IsUnknownWhereThereIsNoTruthOrNoCovariance) {
  Drive run = drive(1.0);
  run.truth.poses.erase(run.truth.poses.begin(), run.truth.poses.begin() + 100);
  const PoseConsistency found = consistency_of(run);
  EXPECT_TRUE(found.errors[100].hasNaN())
      << "the first with a truth is what others are held against";
  EXPECT_TRUE(found.errors[99].hasNaN());
  EXPECT_TRUE(found.errors[101].allFinite());
  EXPECT_EQ(found.errors.size(), kManySweeps);
  for (SweepRecord& sweep : run.review.sweeps) {
    sweep.uncertainty = kUnknownUncertainty;
  }
  EXPECT_FALSE(pose_consistency(run.review, run.estimate, run.truth, 0.01)) << "an older table";
}

TEST(PoseConsistency, IsToldAndDrawnByEvaluate) {
  const test::TemporaryFolder folder;
  const Drive run = drive(1.0);
  SweepTableWriter table(folder / "sweeps.csv");
  for (const SweepRecord& sweep : run.review.sweeps) {
    table.write(sweep);
  }
  table.close();
  write_trajectory(folder / "trajectory.tum", TrajectoryFormat::tum, run.estimate.poses);
  write_trajectory(folder / "truth.tum", TrajectoryFormat::tum, run.truth.poses);
  EvaluateCommandOptions options;
  options.estimates = {folder.path()};
  options.truth = folder / "truth.tum";
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(evaluate_command(options, out, err), 0) << err.str();
  EXPECT_NE(out.str().find("(NEES; 1: as its covariance promises"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("known to     0.062 m and 4.6 mrad relative to the submap"),
            std::string::npos)
      << out.str();
  const std::string page = test::content(folder / "evaluation.html");
  for (const char* part :
       {"Error of the position along z (cm", "Error of the attitude about x (mrad", ">3 sigma<",
        "How well the position is known (cm"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(page.find("nan"), std::string::npos);
  options.json = true;
  out.str("");
  EXPECT_EQ(evaluate_command(options, out, err), 0) << err.str();
  const nlohmann::json json = nlohmann::json::parse(out.str());
  EXPECT_NEAR(json["consistency"]["nees_per_degree_since_first_sweep"]["pose"].get<double>(),
              consistency_of(run).since_first.pose, 1e-9);
  EXPECT_NEAR(json["run"]["sigma_at_the_end"]["local"]["position_m"].get<double>(),
              std::sqrt(0.0038), 1e-12);
}

}  // namespace
}  // namespace adit
