// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/euroc_folder.hpp"

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

const std::string kImu =
    "#timestamp [ns],w_RS_S_x [rad s^-1],...\n"
    "1403715273262142976,-0.25,0.5,0.75,9.0,0.125,-3.5\r\n"
    "1403715273267142976, 0.0, 0.0, 0.0, 9.5, 0.0, -3.0\n";
const std::string kTruth =
    "#timestamp, p_RS_R_x [m],...\n"
    "1403715273264142976,1.0,2.0,3.0,0.0,0.0,0.0,1.0,0.1,0.2,0.3,0,0,0,0,0,0\n";

class EurocFolder : public testing::Test {
 protected:
  void write(const std::string& sensor, const std::string& text) {
    fs::create_directories(folder_ / "mav0" / sensor);
    std::ofstream(folder_ / "mav0" / sensor / "data.csv", std::ios::binary) << text;
  }

  test::TemporaryFolder folder_;
};

TEST_F(EurocFolder, ImuAndPosesComeInTheOrderOfTime) {
  write("imu0", kImu);
  write("state_groundtruth_estimate0", kTruth);
  write("cam0", "#timestamp,filename\n1403715273262142976,a.png\n");
  for (const fs::path& path : {fs::path(folder_.path()), folder_ / "mav0"}) {
    const auto recording = open_recording(path);
    ASSERT_EQ(recording->topics().size(), 2U);
    EXPECT_EQ(recording->topics()[0].name, "/imu0");
    EXPECT_EQ(recording->topics()[0].messages, 2U);
    EXPECT_EQ(recording->topics()[1].messages, 1U);
    const test::ReadEvents read = test::read_all(*recording);
    ASSERT_EQ(read.events.size(), 3U);
    const auto& imu = std::get<ImuSample>(read.events[0].value);
    EXPECT_EQ(imu.stamp, Nanoseconds(1403715273262142976));
    EXPECT_EQ(imu.angular_velocity, Eigen::Vector3d(-0.25, 0.5, 0.75));
    EXPECT_EQ(imu.linear_acceleration, Eigen::Vector3d(9.0, 0.125, -3.5));
    const auto& pose = std::get<ReferencePose>(read.events[1].value);
    EXPECT_EQ(pose.T_parent_child.translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
    EXPECT_TRUE(pose.T_parent_child.linear().isApprox(
        Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal().toDenseMatrix()));
    EXPECT_EQ(std::get<ImuSample>(read.events[2].value).linear_acceleration.x(), 9.5);
  }
}

TEST_F(EurocFolder, TheTruthAloneIsEnough) {
  write("state_groundtruth_estimate0", kTruth);
  const auto recording = open_recording(folder_.path());
  ASSERT_EQ(recording->topics().size(), 1U);
  EXPECT_EQ(test::read_all(*recording).events.size(), 1U);
}

TEST_F(EurocFolder, SelectionByTopicTimeAndNumber) {
  write("imu0", kImu);
  write("vicon0", kTruth);
  const auto recording = open_recording(folder_.path());
  EXPECT_EQ(test::read_all(*recording, {.topics = {1}}).events.size(), 1U);
  EXPECT_EQ(test::read_all(*recording, {.begin = Nanoseconds(1403715273265000000)}).events.size(),
            1U);
  EXPECT_EQ(test::read_all(*recording, {.skip = 2}).events.size(), 1U);
}

TEST_F(EurocFolder, QuaternionBeyondAllBoundsIsRefusedInWords) {
  write("imu0", kImu);
  write("state_groundtruth_estimate0", "1403715273264142976,1.0,2.0,3.0,1e200,0.0,0.0,0.0\n");
  const test::ReadEvents read = test::read_all(*open_recording(folder_.path()));
  ASSERT_EQ(read.errors.size(), 1U);
  EXPECT_NE(read.errors[0].found().find("the length of more than 1000"), std::string::npos)
      << read.errors[0].found();
}

TEST_F(EurocFolder, LinesThatAreNoneAreNamedAndPassedOver) {
  write("imu0",
        "12a,1,2,3,4,5,6\n" + kImu + "7,1,2,3,4,5\n8,1,2,x,4,5,6\n" + std::string(5000, '1'));
  const test::ReadEvents read = test::read_all(*open_recording(folder_.path()));
  EXPECT_EQ(read.events.size(), 2U);
  ASSERT_EQ(read.errors.size(), 4U);
  EXPECT_EQ(read.errors[0].place(), "line 1");
  EXPECT_NE(read.errors[1].found().find("5 numbers behind the time"), std::string::npos);
  EXPECT_NE(read.errors[2].found().find("no number"), std::string::npos);
  EXPECT_NE(read.errors[3].found().find("more than 4095 bytes"), std::string::npos);
}

TEST_F(EurocFolder, CutOffOrChangedAnywhereItIsReadToAnEnd) {
  std::mt19937 random(3);
  for (int i = 0; i < 400; ++i) {
    std::string text = kImu;
    if (i < 200) {
      text.resize(static_cast<std::size_t>(i) % text.size());
    } else {
      text[random() % text.size()] = static_cast<char>(random());
    }
    write("imu0", text);
    const test::ReadEvents read = test::read_all(*open_recording(folder_.path()));
    EXPECT_LE(read.events.size(), 2U);
    EXPECT_LE(read.errors.size(), 4U);
  }
}

}  // namespace
}  // namespace adit
