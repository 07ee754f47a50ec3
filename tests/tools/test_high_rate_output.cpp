// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/high_rate_output.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/simulated_imu.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"

namespace adit {
namespace {

/// Writes what high-rate odometry gives.
struct Written {
  explicit Written(const std::filesystem::path& folder) : output(folder) {}

  void feed(const test::WavyMotion& motion, double begin, double end) {
    for (const ImuSample& sample : test::readings(motion, begin, end, 200.0)) {
      if (const auto pose = stream.add(sample, ImuArrival::appended)) {
        output.write(*pose);
      }
    }
  }

  HighRateStream stream{ImuConfig{}, 0.0};
  HighRateOutput output;
};

InertialReport fused_at(const test::WavyMotion& motion, double time) {
  InertialReport report;
  report.nav = motion.state(time);
  report.nav_covariance = 1e-4 * StateMatrix::Identity();
  return report;
}

TEST(HighRateOutput, WritesEachPoseTwiceWithRisingStampsAndCountsThem) {
  const test::TemporaryFolder folder;
  const test::WavyMotion motion = test::hand_held_motion();
  Written written(folder.path());
  HighRateOutput& output = written.output;
  written.feed(motion, 0.0, 0.1);
  written.stream.update(fused_at(motion, 0.0));
  written.feed(motion, 0.105, 0.3);
  written.stream.update({});  // not fused any more
  written.feed(motion, 0.305, 0.6);
  written.stream.update(fused_at(motion, 0.5));
  written.feed(motion, 0.605, 0.7);
  output.close();

  const Trajectory poses = read_trajectory(folder / "odometry_highrate.tum");
  ASSERT_EQ(poses.poses.size(), 60U);
  for (std::size_t i = 1; i < poses.poses.size(); ++i) {
    EXPECT_GT(poses.poses[i].stamp, poses.poses[i - 1].stamp);
  }
  for (const StampedPose& pose : poses.poses) {
    const Eigen::Isometry3d truth = motion.state(seconds(pose.stamp)).T_map_body;
    EXPECT_LE((truth.inverse() * pose.pose).translation().norm(), 1e-3);
  }
  EXPECT_EQ(test::lines(folder / "odometry_highrate.csv"), 61U);
  const std::string csv = test::content(folder / "odometry_highrate.csv");
  const std::string head = csv.substr(0, csv.find('\n'));
  EXPECT_EQ(std::ranges::count(head, ','), 13 + 45) << head;
  const std::string last = csv.substr(csv.rfind('\n', csv.size() - 2) + 1);
  EXPECT_EQ(std::ranges::count(last, ','), 13 + 45) << last;

  const nlohmann::ordered_json json = to_json(output.statistics());
  EXPECT_EQ(json["poses"], 60);
  EXPECT_EQ(json["interruptions"], 1);
  EXPECT_NEAR(json["rate_hz"].get<double>(), 200.0, 1e-6);
  EXPECT_EQ(describe(output.statistics()),
            "60 poses at 200.0 Hz, 1 interruption(s) while it was not fused");
}

/// At 200 Hz a line of the table is what fills the disk.
TEST(HighRateOutput, LineIsHalfAsLongAsThatOfDoubles) {
  const test::TemporaryFolder folder;
  const test::WavyMotion motion = test::hand_held_motion();
  Written written(folder.path());
  InertialReport report = fused_at(motion, 0.0);
  const Eigen::VectorXd uneven = Eigen::VectorXd::LinSpaced(report.nav_covariance.rows(), 0.1, 0.7);
  report.nav_covariance += 1e-5 * uneven * uneven.transpose();
  written.feed(motion, 0.0, 0.5);
  written.stream.update(report);
  written.feed(motion, 0.505, 1.0);
  written.output.close();
  const std::string csv = test::content(folder / "odometry_highrate.csv");
  const std::size_t lines = test::lines(folder / "odometry_highrate.csv");
  ASSERT_GT(lines, 100U);
  EXPECT_LT(static_cast<double>(csv.size()) / static_cast<double>(lines), 800.0);
}

TEST(HighRateOutput, SaysThatThereWasNothingToCarryOn) {
  const test::TemporaryFolder folder;
  Written written(folder.path());
  HighRateOutput& output = written.output;
  written.feed(test::hand_held_motion(), 0.0, 1.0);
  written.stream.update({});
  output.close();
  EXPECT_EQ(describe(output.statistics()), "0 poses: the IMU was never fused");
  EXPECT_TRUE(to_json(output.statistics())["rate_hz"].is_null());
}

}  // namespace
}  // namespace adit
