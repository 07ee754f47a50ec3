// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/kitti_raw.hpp"

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/shared_data.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {
namespace {

/// A reading at rest, but for the numbers given.
std::string reading(double latitude, double longitude, double altitude, double roll = 0.0,
                    double pitch = 0.0, double yaw = 0.0) {
  return fmt::format(
      "{:.12f} {:.13f} {:.11f} {:.6f} {:.6f} {:.13f} 0 0 0 0 0 0.5 -0.25 9.75 0 0 9.8 0.01 0.02 "
      "0.03 0.1 0.2 0.3 0.5 0.02 4 10 6 4 0\n",
      latitude, longitude, altitude, roll, pitch, yaw);
}

constexpr const char* kImuToVelodyne =
    "calib_time: 25-May-2012 16:47:16\n"
    "R: 9.999976e-01 7.553071e-04 -2.035826e-03 -7.854027e-04 9.998898e-01 -1.482298e-02 "
    "2.024406e-03 1.482454e-02 9.998881e-01\nT: -8.086759e-01 3.195559e-01 -7.997231e-01\n";

/// A drive of two sweeps and three readings.
class KittiRaw : public testing::Test {
 protected:
  KittiRaw() {
    for (const char* name : {"0000000000", "0000000001"}) {
      write(std::string("velodyne_points/data/") + name + ".bin", std::string(32, '\1'));
    }
    write("velodyne_points/timestamps.txt",
          "2011-09-26 13:02:25.951199337\n2011-09-26 13:02:26.054509000\n");
    write("oxts/timestamps.txt",
          "2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26.004389445\n"
          "2011-09-26 13:02:26.074393000\n");
    for (int i = 0; i < 3; ++i) {
      write("oxts/data/000000000" + std::to_string(i) + ".txt", reading(49.0, 8.4, 110.0 + i));
    }
    folder_.write("2011_09_26/calib_imu_to_velo.txt", kImuToVelodyne);
  }

  void write(const std::string& name, const std::string& content) {
    folder_.write("2011_09_26/drive/" + name, content);
  }
  std::filesystem::path drive() const { return folder_ / "2011_09_26/drive"; }

  test::TemporaryFolder folder_;
};

TEST_F(KittiRaw, SweepsReadingsAndMountingComeInTheOrderOfTime) {
  const auto recording = open_recording(drive());
  ASSERT_EQ(recording->topics().size(), 5U);
  EXPECT_EQ(recording->topics()[1].name, "/oxts/imu");
  EXPECT_EQ(recording->topics()[4].kind, TopicKind::transforms);
  const test::ReadEvents read = test::read_all(*recording);
  EXPECT_TRUE(read.errors.empty());
  ASSERT_EQ(read.events.size(), 2U + 3U * 3U + 1U);
  EXPECT_TRUE(std::holds_alternative<Sweep>(read.events[0].value));
  EXPECT_EQ(read.events[0].frame, "velodyne");
  const auto& imu = std::get<ImuSample>(read.events[1].value);
  EXPECT_EQ(imu.stamp, Nanoseconds(1317042145964389445));
  EXPECT_EQ(imu.linear_acceleration, Eigen::Vector3d(0.5, -0.25, 9.75));
  EXPECT_EQ(imu.angular_velocity, Eigen::Vector3d(0.01, 0.02, 0.03));
  const auto& fix = std::get<GnssFix>(read.events[2].value);
  EXPECT_EQ(fix.kind, GnssFixKind::ground_augmented);
  EXPECT_EQ(fix.latitude, 49.0);
  EXPECT_EQ(fix.longitude, 8.4);
  EXPECT_DOUBLE_EQ(fix.covariance.value()(0, 0), 0.25);
  const auto& transform = std::get<StaticTransform>(read.events[4].value);
  EXPECT_EQ(transform.parent, "velodyne");
  EXPECT_EQ(transform.child, "imu");
  EXPECT_EQ(transform.T_parent_child.translation().x(), -0.8086759);
  const auto& pose = std::get<ReferencePose>(read.events.back().value);
  EXPECT_TRUE(pose.T_parent_child.translation().isApprox(Eigen::Vector3d(0.0, 0.0, 2.0)));
}

TEST_F(KittiRaw, SelectionByTopicTimeAndNumber) {
  const auto recording = open_recording(drive());
  EXPECT_EQ(test::read_all(*recording, {.topics = {0}}).events.size(), 2U);
  EXPECT_EQ(test::read_all(*recording, {.topics = {0}, .skip = 1}).events.size(), 1U);
  const Nanoseconds late(1317042146000000000);
  EXPECT_EQ(test::read_all(*recording, {.topics = {0, 1}, .begin = late}).events.size(), 3U);
}

TEST_F(KittiRaw, WhatIsDamagedIsNamedAndTheRestIsRead) {
  write("oxts/data/0000000001.txt", "49.0 8.4 110.0");
  const test::ReadEvents read = test::read_all(*open_recording(drive()));
  EXPECT_EQ(read.events.size(), 2U + 2U * 3U + 1U);
  ASSERT_EQ(read.errors.size(), 3U);  // each of the three series reads it
  EXPECT_EQ(read.errors[0].file().filename(), "0000000001.txt");
  EXPECT_NE(read.errors[0].found().find("3 numbers, expected 30"), std::string::npos);
}

TEST_F(KittiRaw, WhatDoesNotFitTogetherIsRefused) {
  write("calib_imu_to_velo.txt", "R: 1 0 0 0 2 0 0 0 1\nT: 0 0 0\n");
  EXPECT_THROW(open_recording(drive()), InputError);
  write("calib_imu_to_velo.txt", kImuToVelodyne);
  EXPECT_NO_THROW(open_recording(drive()));
  std::filesystem::remove(drive() / "oxts/data/0000000002.txt");
  EXPECT_THROW(open_recording(drive()), InputError);
}

TEST(KittiOxts, CutOffAndDamagedReadingsAreRefusedOrFinite) {
  std::mt19937 random(5);
  const std::string good = reading(49.0, 8.4, 110.0);
  for (std::size_t size = 0; size + 2 < good.size(); ++size) {
    EXPECT_THROW(kitti_fix({}, good.substr(0, size)), SeriesLineError) << size;
  }
  for (int i = 0; i < 3000; ++i) {
    std::string line = good;
    line[random() % line.size()] = static_cast<char>(random());
    try {
      const GnssFix fix = kitti_fix({}, line);
      EXPECT_LT(std::abs(fix.latitude), 90.0);
      EXPECT_TRUE(kitti_imu({}, line).linear_acceleration.allFinite());
    } catch (const SeriesLineError&) {
      // the other right answer
    }
  }
}

TEST(KittiOxts, PosesAreThoseThatOthersDerivedFromTheSameReadings) {
  ADIT_SHARED_DATA_OR_SKIP(data, "kitti_0001");
  const test::TemporaryFolder folder;
  folder.write("drive/calib_imu_to_velo.txt", kImuToVelodyne);
  std::ifstream ins(data / "ins.csv");
  std::string line;
  std::getline(ins, line);
  std::string times;
  for (int i = 0; std::getline(ins, line); ++i) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    double v[8];
    for (double& value : v) {
      words >> value;
    }
    folder.write(fmt::format("drive/oxts/data/{:010}.txt", i),
                 reading(v[2], v[3], v[4], v[5], v[6], v[7]));
    folder.write(fmt::format("drive/velodyne_points/data/{:010}.bin", i), "");
    times += fmt::format("{:.6f}\n", v[1]);
  }
  folder.write("drive/oxts/timestamps.txt", times);
  folder.write("drive/velodyne_points/timestamps.txt", times);
  const auto recording = open_recording(folder / "drive");
  const std::vector<StampedPose> truth =
      read_trajectory(data / "poses_velo.txt", data / "times.txt").poses;
  Eigen::Isometry3d T_velodyne_imu;
  std::vector<Eigen::Isometry3d> poses;
  for (const Event& event : test::read_all(*recording, {.topics = {3, 4}}).events) {
    if (const auto* transform = std::get_if<StaticTransform>(&event.value)) {
      T_velodyne_imu = transform->T_parent_child;
    } else {
      poses.push_back(std::get<ReferencePose>(event.value).T_parent_child);
    }
  }
  ASSERT_EQ(poses.size(), truth.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Isometry3d T =
        T_velodyne_imu * poses[0].inverse() * poses[i] * T_velodyne_imu.inverse();
    EXPECT_LT((T.translation() - truth[i].pose.translation()).norm(), 0.01) << i;
    EXPECT_LT((T.linear() - truth[i].pose.linear()).norm(), 1e-4) << i;
  }
}

}  // namespace
}  // namespace adit
