// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/euroc_folder.hpp"

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

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

TEST_F(EurocFolder, ColumnsAreFoundByTheirNamesAndUnits) {
  const std::string stamp = "1403715273262142976";
  const std::vector<std::string> tables = {
      "#timestamp [ns],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2],w_RS_S_x "
      "[rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1]\n" +
          stamp + ",1,2,9,0.1,0.2,0.3\n",
      "timestamp;ax;ay;az;wx;wy;wz\r\n" + stamp + ";1;2;9;0.1;0.2;0.3\r\n",
      "\xef\xbb\xbf\"timestamp\"\taccel_x\taccel_y\taccel_z\tgyro_x\tgyro_y\tgyro_z\n" + stamp +
          "\t1\t2\t9\t0.1\t0.2\t0.3\n",
      "# made by hand\n#gyro_z,temperature [C],gyro_y,gyro_x,acc_z,acc_y,acc_x,time [s]\n"
      "0.3,25,0.2,0.1,9,2,1,1403715273.262142976\n",
      "#timestamp [us] wx [rad/s] wy [rad/s] wz [rad/s] ax ay az\n"
      "1403715273262142.976 0.1 0.2 0.3 1 2 9\n"};
  for (const std::string& text : tables) {
    write("imu0", text);
    const test::ReadEvents read = test::read_all(*open_recording(folder_.path()));
    ASSERT_EQ(read.events.size(), 1U) << text;
    EXPECT_TRUE(read.errors.empty()) << text;
    const auto& imu = std::get<ImuSample>(read.events[0].value);
    EXPECT_NEAR(seconds(imu.stamp), 1403715273.262142976, 1e-6) << text;
    EXPECT_EQ(imu.angular_velocity, Eigen::Vector3d(0.1, 0.2, 0.3)) << text;
    EXPECT_EQ(imu.linear_acceleration, Eigen::Vector3d(1.0, 2.0, 9.0)) << text;
  }
  write("imu0", "#t [ns],gx [deg/s],gy [deg/s],gz [deg/s],ax [g],ay [g],az [g]\n" + stamp +
                    ",90,0,0,0,0,1\n");
  const test::ReadEvents read = test::read_all(*open_recording(folder_.path()));
  const auto& imu = std::get<ImuSample>(read.events.at(0).value);
  EXPECT_NEAR(imu.angular_velocity.x(), 1.5707963, 1e-6);
  EXPECT_NEAR(imu.linear_acceleration.z(), 9.80665, 1e-9);
}

TEST_F(EurocFolder, PosesAreFoundByTheirNamesToo) {
  write("state_groundtruth_estimate0",
        "#timestamp, q_RS_x [], q_RS_y [], q_RS_z [], q_RS_w [], p_RS_R_z [m], p_RS_R_y [m], "
        "p_RS_R_x [m]\n1403715273264142976,0,0,1,0,3,2,1\n");
  const test::ReadEvents read = test::read_all(*open_recording(folder_.path()));
  ASSERT_EQ(read.events.size(), 1U);
  const auto& pose = std::get<ReferencePose>(read.events[0].value);
  EXPECT_EQ(pose.T_parent_child.translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_NEAR(pose.T_parent_child.linear()(0, 0), -1.0, 1e-12);
}

TEST_F(EurocFolder, MissingColumnsAndUnknownUnitsAreNamed) {
  const auto said = [&](const std::string& head) {
    write("imu0", head + "\n1403715273262142976,1,2,3,4,5\n");
    try {
      open_recording(folder_.path());
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), "line 1");
      return error.found();
    }
    return std::string();
  };
  EXPECT_EQ(said("#timestamp [ns],wx,wy,wz,ax,ay"),
            "it names some columns, and none for the acceleration along z");
  EXPECT_EQ(said("#timestamp [ns],wx [furlong],wy,wz,ax,ay,az"),
            "the unit of column 'wx [furlong]' is unknown");
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
