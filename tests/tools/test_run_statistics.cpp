// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_statistics.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/tools/run_support.hpp"

namespace adit {
namespace {

SweepResult failed(RegistrationStatus status) {
  SweepResult result;
  result.state = OdometryState::coasting;
  result.registration.status = status;
  result.registration.overlap = 0.123;
  result.registration.inliers = 42;
  result.registration.iterations = 20;
  result.raw_points = result.valid_points = result.cloud_points = 1000;
  return result;
}

TEST(RunStatistics, PercentilesAreValuesThatOccurred) {
  std::vector<float> values;
  for (int i = 100; i >= 1; --i) {
    values.push_back(static_cast<float>(i));
  }
  const Distribution d = distribution(values);
  EXPECT_EQ(d.count, 100U);
  EXPECT_DOUBLE_EQ(d.mean, 50.5);
  EXPECT_EQ(d.p50, 50.0);
  EXPECT_EQ(d.p95, 95.0);
  EXPECT_EQ(d.max, 100.0);
}

TEST(RunStatistics, OneValueIsEveryPercentileAndNoneGivesZeros) {
  const Distribution one = distribution({3.0F});
  EXPECT_EQ(one.p50, 3.0);
  EXPECT_EQ(one.p95, 3.0);
  EXPECT_EQ(distribution({}).count, 0U);
}

TEST(RunStatistics, FailuresAreExplainedWithTheNumbersAndTheSettingsThatDecided) {
  const Config config;
  const auto expect = [&](const SweepResult& sweep, const std::vector<std::string>& parts) {
    const std::string reason = failure_reason(sweep, config).value_or("");
    for (const std::string& part : parts) {
      EXPECT_NE(reason.find(part), std::string::npos) << "no '" << part << "' in: " << reason;
    }
  };
  expect(failed(RegistrationStatus::too_little_overlap),
         {"12 %", "30 %", "registration.min_overlap"});
  expect(failed(RegistrationStatus::too_few_points), {"42", "100", "registration.min_inliers"});
  expect(failed(RegistrationStatus::not_converged), {"20 iterations"});
  expect(failed(RegistrationStatus::diverged), {"diverged"});
  SweepResult doubtful = failed(RegistrationStatus::doubtful);
  doubtful.rejection = TwoPlaces{.competing_share = 0.95};
  expect(doubtful, {"a search found two places"});
  SweepResult thin = failed(RegistrationStatus::too_few_points);
  thin.cloud_points = 7;
  expect(thin, {"only 7 points", "registration.min_inliers"});
  SweepResult empty = failed(RegistrationStatus::too_few_points);
  empty.valid_points = 0;
  expect(empty, {"none of its 1000 points", "preprocess.c_min"});
  empty.raw_points = 0;
  expect(empty, {"no points"});
}

TEST(RunStatistics, SweepsThatWerePlacedAreNoFailures) {
  test::MemoryRecording recording(2);
  EXPECT_FALSE(failure_reason(test::placed(recording.read(0)), Config{}));
  EXPECT_FALSE(failure_reason(test::placed(recording.read(1)), Config{}));
}

TEST(RunStatistics, CountsDistanceStatesAndTimes) {
  test::MemoryRecording recording(4);
  RunStatistics statistics{Config{}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Sweep sweep = recording.read(i);
    const HostTimes times{.read = 9.0, .total = 10.0 + static_cast<double>(i)};
    EXPECT_FALSE(statistics.add(i, sweep, test::placed(sweep), times));
  }
  SweepResult bad = failed(RegistrationStatus::too_little_overlap);
  bad.T_map_lidar.translation() = Eigen::Vector3d(2.0, 3.0, 4.0);  // 5 m beside the last one
  bad.lost_points = 3;
  bad.crowded_voxels = 2;
  const auto failure = statistics.add(3, recording.read(3), bad, {});
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->index, 3U);
  EXPECT_EQ(failure->source, "sweep_3");

  EXPECT_EQ(statistics.sweeps(), 4U);
  EXPECT_EQ(statistics.keyframes(), 3U);
  EXPECT_EQ(statistics.lost_points(), 3U);
  EXPECT_EQ(statistics.crowded_voxels(), 2U);
  EXPECT_NEAR(statistics.distance(), 7.0, 1e-12);
  EXPECT_EQ(statistics.count(OdometryState::initializing), 1U);
  EXPECT_EQ(statistics.count(OdometryState::tracking), 2U);
  EXPECT_EQ(statistics.count(OdometryState::coasting), 1U);
  EXPECT_EQ(statistics.count(RegistrationStatus::converged), 2U)
      << "the first sweep is not aligned";
  EXPECT_EQ(statistics.count(RegistrationStatus::too_little_overlap), 1U);
  EXPECT_EQ(statistics.host_stages().front().stage, "read");
  EXPECT_EQ(statistics.host_stages().front().ms, (std::vector<float>{9.0F, 9.0F, 9.0F, 0.0F}));
  EXPECT_EQ(statistics.host_stages().back().stage, "total");
  EXPECT_EQ(statistics.host_stages().back().ms, (std::vector<float>{10.0F, 11.0F, 12.0F, 0.0F}));
}

TEST(RunStatistics, DeviceStagesKeepTheirOrderAndTheSumStaysLast) {
  test::MemoryRecording recording(2);
  RunStatistics statistics{Config{}};
  SweepResult first = test::placed(recording.read(0));
  first.stages = {{"downsample", 1.0}};
  SweepResult second = test::placed(recording.read(1));
  second.stages = {{"downsample", 2.0}, {"align", 5.0}};
  statistics.add(0, recording.read(0), first, {});
  statistics.add(1, recording.read(1), second, {});
  const auto& stages = statistics.device_stages();
  ASSERT_EQ(stages.size(), 3U);
  EXPECT_EQ(stages[0].stage, "downsample");
  EXPECT_EQ(stages[1].stage, "align");
  EXPECT_EQ(stages[1].ms, std::vector<float>{5.0F});
  EXPECT_EQ(stages[2].stage, "total");
  EXPECT_EQ(stages[2].ms, (std::vector<float>{1.0F, 7.0F}));
}

}  // namespace
}  // namespace adit
