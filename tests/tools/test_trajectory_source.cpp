// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A trajectory is read from whatever holds one.
#include "adit/tools/evaluation/trajectory_source.hpp"

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/results/sweep_table.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr Nanoseconds kFirstStamp{1'700'000'000'000'000'000};

/// Half a turn on a circle of 5 m.
std::vector<StampedPose> half_circle() {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 50; ++i) {
    const double angle = std::acos(-1.0) * i / 50.0;
    StampedPose pose{.stamp = kFirstStamp + std::chrono::milliseconds(100 * i)};
    pose.pose.translation() << 5.0 * std::cos(angle), 5.0 * std::sin(angle), 0.1 * i;
    pose.pose.linear() =
        Eigen::AngleAxisd(angle, Eigen::Vector3d(0.1, 0.2, 1.0).normalized()).toRotationMatrix();
    poses.push_back(pose);
  }
  return poses;
}

void expect_half_circle(const Trajectory& found, const std::string& from) {
  const std::vector<StampedPose> wanted = half_circle();
  EXPECT_TRUE(found.stamped) << from;
  ASSERT_EQ(found.poses.size(), wanted.size()) << from;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_EQ(found.poses[i].stamp, wanted[i].stamp) << from << ", pose " << i;
    EXPECT_TRUE(found.poses[i].pose.isApprox(wanted[i].pose, 1e-9)) << from << ", pose " << i;
  }
}

/// "x,y,z" and the quaternion in either order.
std::string cells(const Eigen::Isometry3d& pose, bool w_first) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d& t = pose.translation();
  std::string line;
  std::vector<double> values = {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  if (w_first) {
    values = {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()};
  }
  for (const double value : values) {
    line += ",";
    append_number(line, value);
  }
  return line;
}

std::string euroc_table() {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1]\r\n";
  for (const StampedPose& pose : half_circle()) {
    text += std::to_string(pose.stamp.count()) + cells(pose.pose, true) + ",0.5\r\n";
  }
  return text;
}

template <class Writer, class Options>
fs::path write_poses(const fs::path& file, Encoding encoding,
                     const std::vector<std::string>& topics) {
  Writer writer(file, Options{});
  for (const std::string& topic : topics) {
    const std::size_t channel = writer.add_channel({.topic = topic,
                                                    .type = "nav_msgs/Odometry",
                                                    .encoding = encoding,
                                                    .definition = {},
                                                    .messages = std::nullopt});
    for (const StampedPose& pose : half_circle()) {
      const ReferencePose event{
          .stamp = pose.stamp, .parent = "odom", .child = "base", .T_parent_child = pose.pose};
      writer.write(channel, pose.stamp, ros::from_event(event, encoding, "base").bytes);
    }
  }
  writer.close();
  return file;
}

TEST(TrajectorySource, TextTablesAndRecordingsGiveTheSame) {
  const test::TemporaryFolder folder;
  write_trajectory(folder / "a.tum", TrajectoryFormat::tum, half_circle());
  expect_half_circle(read_any_trajectory({.path = folder / "a.tum"}), "TUM");
  expect_half_circle(read_any_trajectory({.path = folder.write("data.csv", euroc_table())}),
                     "EuRoC's table");
  std::string named = "stamp_s,state,x_m,y_m,z_m,qx,qy,qz,qw\n";
  for (const StampedPose& pose : half_circle()) {
    append_stamp(named, pose.stamp);
    named += ",tracking" + cells(pose.pose, false) + "\n";
  }
  expect_half_circle(read_any_trajectory({.path = folder.write("named.csv", named)}), "a table");
  expect_half_circle(read_any_trajectory({.path = write_poses<McapWriter, McapOptions>(
                                              folder / "a.mcap", Encoding::cdr, {"/odom"})}),
                     "MCAP");
  expect_half_circle(read_any_trajectory({.path = write_poses<BagWriter, BagOptions>(
                                              folder / "a.bag", Encoding::ros1, {"/odom"})}),
                     "bag");
}

TEST(TrajectorySource, EurocFolderAndTheFolderOfARunAreRead) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "mav0/imu0");
  fs::create_directories(folder / "mav0/state_groundtruth_estimate0");
  folder.write("mav0/imu0/data.csv", "#timestamp,w\n1700000000000000000,0,0,0,0,0,9.8\n");
  folder.write("mav0/state_groundtruth_estimate0/data.csv", euroc_table());
  expect_half_circle(read_any_trajectory({.path = folder.path()}), "EuRoC's folder");
  fs::create_directory(folder / "out");
  write_trajectory(folder / "out/trajectory.tum", TrajectoryFormat::tum, half_circle());
  expect_half_circle(read_any_trajectory({.path = folder / "out"}), "the folder of a run");
}

TEST(TrajectorySource, TableOfSweepsHasTheirPoses) {
  const test::TemporaryFolder folder;
  SweepTableWriter table(folder / "sweeps.csv");
  for (const StampedPose& pose : half_circle()) {
    SweepResult sweep;
    sweep.stamp = pose.stamp;
    sweep.T_map_lidar = pose.pose;
    table.write(sweep_record(0, sweep));
  }
  table.close();
  expect_half_circle(read_any_trajectory({.path = folder / "sweeps.csv"}), "sweeps.csv");
}

TEST(TrajectorySource, SimulatorsOwnTruthIsRead) {
  const test::TemporaryFolder folder;
  SimulationOptions options;
  options.scene = "room";
  options.duration = 1.0;
  options.picture = false;
  options.output = folder / "room.mcap";
  simulate(options, [](std::size_t, std::size_t) {});
  const SimulationFiles files(options.output);
  const Trajectory lidar = read_any_trajectory({.path = files.trajectory});
  const Trajectory imu = read_any_trajectory({.path = files.states});
  ASSERT_EQ(imu.poses.size(), lidar.poses.size());
  const Eigen::Isometry3d found = imu.poses[7].pose.inverse() * lidar.poses[7].pose;
  EXPECT_TRUE(found.isApprox(options.lidars.front().T_imu_lidar, 1e-6)) << found.matrix();
}

TEST(TrajectorySource, SeveralSeriesAreNamedAndOneIsChosen) {
  const test::TemporaryFolder folder;
  const fs::path file =
      write_poses<McapWriter, McapOptions>(folder / "a.mcap", Encoding::cdr, {"/odom", "/truth"});
  try {
    read_any_trajectory({.path = file});
    FAIL() << "there are two";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/odom, /truth"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("--truth-topic"), std::string::npos) << error.what();
  }
  expect_half_circle(read_any_trajectory({.path = file, .times = {}, .topic = "/truth"}), "/truth");
  EXPECT_THROW(read_any_trajectory({.path = file, .times = {}, .topic = "/none"}), InputError);
}

TEST(TrajectorySource, TableWithoutAColumnNamesItAndDamageItsLine) {
  const test::TemporaryFolder folder;
  const auto said = [&](const std::string& text) -> std::string {
    try {
      read_any_trajectory({.path = folder.write("a.csv", text)});
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_NE(said("t_s,x_m,y_m,height,qx,qy,qz,qw\n").find("no column is z"), std::string::npos);
  const std::string head = "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n";
  EXPECT_NE(said(head + "1,0,0,0,0,0,0,1\n2,0,0,x,0,0,0,1\n").find("line 3"), std::string::npos);
  EXPECT_NE(said(head + "1,0,0,0,0,0,0,1\n2,0\n").find("cells found: 2"), std::string::npos);
  EXPECT_NE(said(head + "1,0,0,0,0,0,0,0\n").find("quaternion"), std::string::npos);
  EXPECT_NE(said(head).find("holds no pose"), std::string::npos);
}

}  // namespace
}  // namespace adit
