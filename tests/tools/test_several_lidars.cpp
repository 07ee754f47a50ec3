// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Two range sensors on one robot: mapped together, one of them unplugged, and mounted otherwise
// than is said.
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/simulator/simulation.hpp"

namespace adit {
namespace {

/// Both are on one robot in a room, 0.6 m apart, and look in opposite directions.
Eigen::Isometry3d rear_mount() {
  Eigen::Isometry3d T_imu_rear = Eigen::Isometry3d::Identity();
  T_imu_rear.linear() = so3_exp({0.0, 0.0, 3.0});
  T_imu_rear.translation() = Eigen::Vector3d(-0.6, 0.0, 0.1);
  return T_imu_rear;
}

std::filesystem::path two_lidars(const test::TemporaryFolder& folder, double seconds,
                                 std::optional<double> unplugged = {}) {
  SimulationOptions simulation;
  simulation.scene = "room";
  simulation.trajectory = "handheld";
  simulation.duration = seconds;
  simulation.picture = false;
  simulation.lidars = {LidarOptions{.topic = "/front", .frame = "front"},
                       LidarOptions{.topic = "/rear", .frame = "rear"}};
  simulation.lidars[1].T_imu_lidar = rear_mount();
  simulation.lidars[1].end = unplugged.value_or(simulation.lidars[1].end);
  simulation.output = folder / "two.mcap";
  simulate(simulation, {});
  return simulation.output;
}

RunCommandOptions merging(const std::filesystem::path& recording,
                          const std::filesystem::path& output) {
  RunCommandOptions options;
  options.recording = recording;
  options.output = output;
  options.topic = "/front";
  options.merged_topics = {"/rear"};
  return options;
}

std::string mounting_setting(const Eigen::Isometry3d& pose) {
  const auto n = numbers_of(pose);
  return fmt::format("recording.T_lidar_further=[[{}, {}, {}, {}, {}, {}, {}]]", n[0], n[1], n[2],
                     n[3], n[4], n[5], n[6]);
}

TEST(SeveralLidars, ARunMapsThemAsOneAndIsTheSameWhenItIsRepeated) {
  const test::TemporaryFolder folder;
  const auto recording = two_lidars(folder, 1.5);
  const test::Ran run = test::ran(run_command, merging(recording, folder / "out"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.err.find("/rear: 15 sweeps, "), std::string::npos) << run.err;
  const nlohmann::json summary = test::json_of(folder / "out" / "summary.json");
  EXPECT_EQ(summary["verdict"]["coverage"]["placed"], 15);
  ASSERT_EQ(test::ran(run_command, merging(recording, folder / "again")).code, 0);
  EXPECT_EQ(test::content(folder / "out" / "trajectory.tum"),
            test::content(folder / "again" / "trajectory.tum"));
  // How many there are is not known before: neither a count beyond the end nor the map's settings
  // make sweeps that are missing.
  RunCommandOptions counted = merging(recording, folder / "counted");
  counted.count = 1000;
  RunCommandOptions from = merging(recording, folder / "from");
  from.recording.clear();
  from.topic.reset();
  from.merged_topics.clear();
  from.from = folder / "out" / "map.adit";
  for (const RunCommandOptions& options : {counted, from}) {
    const test::Ran other = test::ran(run_command, options);
    ASSERT_EQ(other.code, 0) << other.err;
    const nlohmann::json coverage =
        test::json_of(options.output / "summary.json")["verdict"]["coverage"];
    EXPECT_EQ(coverage["sweeps"], 15) << options.output;
    EXPECT_EQ(coverage["missing"], 0);
  }
  RunCommandOptions alone = merging(recording, folder / "alone");
  alone.merged_topics.clear();
  ASSERT_EQ(test::ran(run_command, alone).code, 0);
  EXPECT_NE(test::content(folder / "out" / "trajectory.tum"),
            test::content(folder / "alone" / "trajectory.tum"));
}

TEST(SeveralLidars, WhereTheFirstIsUnpluggedTheOtherGoesOn) {
  const test::TemporaryFolder folder;
  const auto recording = two_lidars(folder, 2.0, 0.7);
  RunCommandOptions options = merging(recording, folder / "out");
  options.topic = "/rear";  // which falls silent
  options.merged_topics = {"/front"};
  const test::Ran run = test::ran(run_command, options);
  ASSERT_EQ(run.code, 0) << run.err;
  const nlohmann::json summary = test::json_of(folder / "out" / "summary.json");
  EXPECT_GE(summary["verdict"]["coverage"]["placed"], 19);
  EXPECT_EQ(summary["verdict"]["coverage"]["missing"], 0);
}

TEST(SeveralLidars, AWrongMountingIsFoundAndCorrected) {
  const test::TemporaryFolder folder;
  InspectCommandOptions options;
  options.recording = two_lidars(folder, 2.0);
  options.json = true;
  options.write_config = folder / "suggested.toml";
  options.config.overrides = {"recording.sweep_topic=/front",
                              "recording.further_sweep_topics=[\"/rear\"]"};
  const auto report = [&] {
    return nlohmann::json::parse(test::ran(inspect_command, options).out);
  };
  const auto is_found = [](const nlohmann::json& json) {
    return std::ranges::any_of(json["findings"], [](const nlohmann::json& finding) {
      return finding["kind"] == "lidar_mounting" && finding["topic"] == "/rear";
    });
  };
  const nlohmann::json right = report();
  EXPECT_GE(right["lidars"][0]["aligned"], 5) << right["lidars"];
  EXPECT_FALSE(is_found(right)) << right["findings"];
  const Eigen::Isometry3d T_front_rear = lidar_mount().inverse() * rear_mount();
  Eigen::Isometry3d wrong = T_front_rear;
  wrong.linear() *= so3_exp({0.0, 3.0 * kDegree, 0.0});
  options.config.overrides.push_back(mounting_setting(wrong));
  EXPECT_TRUE(is_found(report()));
  const Config corrected = load_config({.file = options.write_config, .overrides = {}});
  ASSERT_EQ(corrected.recording.T_lidar_further.size(), 1U);
  const Vector6d error =
      se3_log(T_front_rear.inverse() * pose_of(corrected.recording.T_lidar_further[0]));
  EXPECT_LT(error.head<3>().norm(), 0.03);
  EXPECT_LT(error.tail<3>().norm(), 0.3 * kDegree);
}

}  // namespace
}  // namespace adit
