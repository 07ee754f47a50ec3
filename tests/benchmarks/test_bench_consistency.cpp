// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/command_bench_consistency.hpp"
#include "adit/benchmarks/consistency/consistency.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"

namespace adit::bench {
namespace {

/// Runs of thirty sweeps along x whose errors have these standard deviations, alike where they are
/// a moment apart; what is said of them is `claimed` times as much. Innovations remember `memory`
/// of the one before.
std::vector<std::vector<ConsistencySweep>> made_up_runs(int count, double claimed, double memory) {
  constexpr double kAlike = 0.8825;  // exp(-0.1 s / 0.8 s)
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Vector6d sigma;
  sigma << 0.01, 0.02, 0.03, 0.001, 0.002, 0.003;
  std::vector<std::vector<ConsistencySweep>> runs(static_cast<std::size_t>(count));
  for (auto& run : runs) {
    Vector6d whitened = Vector6d::Zero();
    Vector6d error = Vector6d::Zero();
    for (int i = 0; i < 30; ++i) {
      const auto white = [&] { return normal(random); };
      whitened = memory * whitened +
                 std::sqrt(1.0 - memory * memory) * Vector6d(Vector6d::NullaryExpr(white));
      const Vector6d fresh = sigma.cwiseProduct(Vector6d(Vector6d::NullaryExpr(white)));
      error = i == 0 ? fresh : Vector6d(kAlike * error + std::sqrt(1.0 - kAlike * kAlike) * fresh);
      ConsistencySweep& sweep = run.emplace_back();
      sweep.T_world_lidar.translation().x() = 0.2 * i;
      SweepResult& result = sweep.result;
      result.stamp = std::chrono::milliseconds(100 * i);
      result.T_map_lidar = retract(sweep.T_world_lidar, error);
      result.uncertainty.local = (claimed * claimed) * sigma.cwiseAbs2().asDiagonal();
      if (i > 0) {
        result.inertial.nav = NavState{};
        result.inertial.innovation = {
            .nis = whitened.squaredNorm(), .degrees = 6, .whitened = whitened};
      }
    }
  }
  return runs;
}

TEST(Consistency, RightCovariancesAndWhiteInnovationsAreCalledSo) {
  const Consistency found = consistency_of(made_up_runs(200, 1.0, 0.0));
  const MeanBounds bounds = chi_squared_bounds(200, 6);
  EXPECT_EQ(found.runs, 200U);
  EXPECT_EQ(found.sweeps, 200U * 29U);
  EXPECT_GT(found.last.pose, bounds.low);
  EXPECT_LT(found.last.pose, bounds.high);
  EXPECT_NEAR(found.all.pose, 1.0, 0.1);
  EXPECT_NEAR(found.all.translation, 1.0, 0.1);
  EXPECT_NEAR(found.all.rotation, 1.0, 0.1);
  EXPECT_NEAR(found.motions[1].pose, 1.0, 0.1);
  EXPECT_NEAR(found.nis, 1.0, 0.1);
  EXPECT_NEAR(found.path, 29 * 0.2, 1e-9);
  for (const double rho : found.correlation) {
    EXPECT_LT(std::abs(rho), 2.0 * white_bound(found));
  }
}

TEST(Consistency, TooSmallCovariancesAndColouredInnovationsShow) {
  const Consistency found = consistency_of(made_up_runs(200, 0.5, 0.6));
  EXPECT_NEAR(found.last.pose, 4.0, 0.8);
  EXPECT_NEAR(found.correlation[0], 0.6, 0.1);
  EXPECT_NEAR(found.correlation[1], 0.36, 0.1);
  EXPECT_GT(found.correlation[1], white_bound(found));
}

// The percentage points of chi squared with 6 and 300 degrees of freedom, from tables; the
// approximation errs by 3 % for one run.
TEST(Consistency, BoundsAreThoseOfTables) {
  EXPECT_NEAR(6.0 * chi_squared_bounds(1, 6).low, 1.237, 0.04);
  EXPECT_NEAR(6.0 * chi_squared_bounds(1, 6).high, 14.449, 0.05);
  EXPECT_NEAR(300.0 * chi_squared_bounds(50, 6).low, 253.91, 0.1);
  EXPECT_NEAR(300.0 * chi_squared_bounds(50, 6).high, 349.87, 0.1);
}

// The whole odometry, two scenes and sensors of the cases, five seconds each.
TEST(BenchConsistency, ShortRunsOfTheWholeOdometryAreHonest) {
  const test::TemporaryFolder folder;
  BenchConsistencyOptions options;
  options.only = {"room", "mine"};
  options.runs = 2;
  options.duration = 5.0;
  options.json = folder.path() / "consistency.json";
  options.config.overrides = {"imu.lag=19"};
  std::ostringstream out;
  std::ostringstream err;
  ASSERT_EQ(bench_consistency_command(options, out, err), 0) << err.str();
  const auto report = test::json_of(options.json);
  ASSERT_EQ(report["cases"].size(), 2U);
  const auto& all = report["all"];
  EXPECT_EQ(all["runs"], 2);
  EXPECT_EQ(all["bridged_sweeps"], 0);
  EXPECT_GE(all["fused_sweeps"], 2 * 30);
  EXPECT_GE(all["nees_a_degree"]["every_pose_in_map"]["pose"], 0.2) << out.str();
  EXPECT_LE(all["nees_a_degree"]["every_pose_in_map"]["pose"], 3.0) << out.str();
  EXPECT_LE(all["innovations"]["correlation_1_to_5_sweeps_apart"][4], 0.3) << out.str();
  EXPECT_NE(out.str().find("pose     NEES"), std::string::npos);
  EXPECT_NE(out.str().find("), imu.lag=19\n"), std::string::npos) << out.str();
  EXPECT_EQ(report["settings"], nlohmann::json({"imu.lag=19"}));
}

TEST(BenchConsistency, RefusesWhatWouldHaveNoEffect) {
  const auto refused = [](const BenchConsistencyOptions& options, const std::string& part) {
    std::ostringstream out;
    std::ostringstream err;
    EXPECT_EQ(bench_consistency_command(options, out, err), 2);
    EXPECT_NE(err.str().find(part), std::string::npos) << err.str();
  };
  for (const char* setting : {"recording.imu_time_offset=0.1", "mapping.delay=6", "gnss.use=false",
                              "imu.T_imu_lidar=[0.0,0.0,0.0,0.0,0.0,0.0,1.0]"}) {
    BenchConsistencyOptions options;
    options.config.overrides = {setting};
    refused(options, std::string(setting) + " has no effect here");
  }
  BenchConsistencyOptions runs;
  runs.runs = 7;
  refused(runs, "--runs 7: 6 cases share them evenly; make it 12");
}

TEST(BenchConsistency, UnknownCasesAndSensorsAreNamed) {
  for (const bool sensor : {false, true}) {
    BenchConsistencyOptions options;
    options.only = {sensor ? "room" : "rom"};
    options.sensor = sensor ? "VLP-61" : "";
    std::ostringstream out;
    std::ostringstream err;
    EXPECT_EQ(bench_consistency_command(options, out, err), 2);
    EXPECT_NE(err.str().find(sensor ? "VLP-61" : "'rom'"), std::string::npos) << err.str();
  }
}

}  // namespace
}  // namespace adit::bench
