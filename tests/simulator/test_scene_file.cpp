// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_file.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <variant>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_simulate.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {
namespace {

class SceneFileTest : public testing::Test {
 protected:
  SimulationOptions read(const std::string& text) const {
    return read_scene_file(folder_.write("scene.toml", text));
  }

  void expect_refused(const std::string& text, const std::string& place,
                      const std::string& part) const {
    try {
      read(text);
      FAIL() << "taken: " << text;
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), place) << error.what();
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }

  test::TemporaryFolder folder_;
};

TEST_F(SceneFileTest, TheExampleSaysTheDefaults) {
  const SimulationOptions options = read(scene_file_example());
  const SimulationOptions expected;
  EXPECT_EQ(options.scene, expected.scene);
  EXPECT_EQ(options.seed, expected.seed);
  EXPECT_EQ(options.duration, expected.duration);
  EXPECT_EQ(options.trajectory, expected.trajectory);
  EXPECT_EQ(options.speed, expected.speed);
  EXPECT_EQ(options.begin, expected.begin);
  EXPECT_EQ(options.imu, expected.imu);
  EXPECT_EQ(options.imu_rate, expected.imu_rate);
  EXPECT_EQ(options.gnss, expected.gnss);
  EXPECT_EQ(options.gnss_rate, expected.gnss_rate);
  EXPECT_EQ(options.p_imu_antenna, expected.p_imu_antenna);
  EXPECT_EQ(options.heading, expected.heading);
  EXPECT_EQ(options.heading_errors.sigma, expected.heading_errors.sigma);
  EXPECT_EQ(options.heading_errors.offset, expected.heading_errors.offset);
  EXPECT_EQ(options.wheels, expected.wheels);
  EXPECT_EQ(options.wheel_rate, expected.wheel_rate);
  EXPECT_TRUE(options.T_imu_wheels.isApprox(wheel_mount()));
  EXPECT_EQ(options.visual_odometry, expected.visual_odometry);
  EXPECT_EQ(options.visual_odometry_rate, expected.visual_odometry_rate);
  EXPECT_TRUE(options.T_imu_camera.isApprox(camera_mount()));
  EXPECT_TRUE(options.faults.empty());
  EXPECT_TRUE(options.waypoints.empty());
  ASSERT_EQ(options.lidars.size(), 1U);
  const LidarOptions& lidar = options.lidars.front();
  EXPECT_EQ(lidar.sensor, expected.lidars.front().sensor);
  EXPECT_EQ(lidar.topic, expected.lidars.front().topic);
  EXPECT_EQ(lidar.frame, expected.lidars.front().frame);
  EXPECT_TRUE(lidar.T_imu_lidar.isApprox(lidar_mount()));
  EXPECT_FALSE(lidar.doppler);
  EXPECT_TRUE(lidar.effects.noise && lidar.effects.dropout && lidar.effects.mixed_pixels &&
              lidar.effects.dust);
}

TEST_F(SceneFileTest, NamesTheLineThatIsWrong) {
  expect_refused("scene = 'room'\nsede = 3\n", "line 2, column 1", "'seed'");
  expect_refused("scene = 'rom'\n", "line 1, column 9", "'room'");
  expect_refused("duration = 'long'\n", "line 1, column 12", "no number");
  expect_refused("[[lidar]]\nsensor = 'VLP16'\n", "line 2, column 10", "'VLP-16'");
  expect_refused("[[lidar]]\nposition = [1, 2]\n", "line 2, column 12", "three numbers");
  expect_refused("[trajectory]\nwaypoints = [[0, 0, 0], 1]\n", "line 2, column 25", "three");
  expect_refused("[imu]\nrate = 99.5\n", "line 2, column 8", "no whole number");
  expect_refused("faults = ['gapp']\n", "line 1, column 10", "'gap'");
  expect_refused("seed = -1\n", "line 1, column 8", "not negative");
  expect_refused("[gnss]\nrate = 10\n", "line 2, column 1", "no receiver");
  expect_refused("[[lidar]]\nsensor = 'VLP-16'\n[[lidar]]\nframe = 'rear'\n", "line 3, column 1",
                 "another range sensor is on /points");
  expect_refused("scene = \n", "line 1, column 9", "TOML");
  expect_refused("seed = 1\n[.5]\n", "line 2, column 2", "TOML");
  expect_refused("seed = 1\n\u00b2\n", "line 2, column 1", "TOML");
}

TEST_F(SceneFileTest, CamerasAreWhereTheirNameOrTheFileSays) {
  const SimulationOptions options = read(
      "[[camera]]\nname = 'left'\nlens = 'fisheye'\nrate = 10\n"
      "[[camera]]\nname = 'back'\nposition = [1, 2, 3]\nyaw_pitch_roll = [90, 0, 0]\n");
  ASSERT_EQ(options.cameras.size(), 2U);
  const CameraOptions& left = options.cameras[0];
  EXPECT_EQ(left.name, "left");
  EXPECT_EQ(left.lens, "fisheye");
  EXPECT_EQ(left.rate, 10);
  EXPECT_TRUE(left.T_imu_camera.isApprox(camera_named("left").T_imu_camera));
  const CameraOptions& back = options.cameras[1];
  EXPECT_EQ(back.lens, "perspective");
  EXPECT_EQ(back.rate, CameraOptions{}.rate);
  EXPECT_TRUE(back.T_imu_camera.translation().isApprox(Eigen::Vector3d(1.0, 2.0, 3.0)));
  EXPECT_TRUE(back.T_imu_camera.linear().col(2).isApprox(Eigen::Vector3d::UnitY()))
      << "the file's rotation, not its name's";
  EXPECT_TRUE(read(scene_file_example()).cameras.empty());
  expect_refused("[[camera]]\nname = 'lef'\n", "line 2, column 8", "'left'");
  expect_refused("[[camera]]\nlens = 'fish'\n", "line 2, column 8", "there is no lens 'fish'");
  expect_refused("[[camera]]\nrate = 0\n", "line 2, column 8", "is 0 Hz");
  expect_refused("[[camera]]\n[[camera]]\n", "line 2, column 1", "two cameras 'front'");
  expect_refused("faults = ['camera-late']\n", "line 1, column 10", "is one of the cameras");
}

TEST_F(SceneFileTest, NumbersThatMakeNoSenseAreNamedWithTheirLine) {
  for (const char* wrong : {"nan", "inf", "-inf"}) {
    const std::string vector = std::string("[") + wrong + ", 0, 0]\n";
    const std::string finite = "not a finite number";
    expect_refused("[trajectory]\nwaypoints = [" + vector + "]", "line 2, column 15", finite);
    expect_refused(std::string("[trajectory]\ncorner_radius = ") + wrong, "line 2, column 17",
                   finite);
    expect_refused("[[lidar]]\nposition = " + vector, "line 2, column 13", finite);
    expect_refused("[[lidar]]\nyaw_pitch_roll = " + vector, "line 2, column 19", finite);
    expect_refused("[gnss]\nreceiver = 'rtk'\nposition = " + vector, "line 3, column 13", finite);
  }
  expect_refused("[[lidar]]\nyaw_pitch_roll = [1e300, 0, 0]\n", "line 2, column 19", "too large");
  expect_refused("duration = 0.1\n", "line 1, column 12", "0.2 to 36000");
  expect_refused("[trajectory]\nspeed = 0\n", "line 2, column 9", "more than 0");
  expect_refused("[trajectory]\nbegin = -1\n", "line 2, column 9", "0 to 100000");
  expect_refused("[trajectory]\ncorner_radius = 0\n", "line 2, column 17", "0.01 to 1000");
  expect_refused("[imu]\nrate = 3\n", "line 2, column 8", "a divisor of 1e9");
  expect_refused("[gnss]\nreceiver = 'rtk'\nrate = 0\n", "line 3, column 8", "a divisor of 1e9");
  expect_refused("faults = ['shock']\nduration = 2.0\n", "line 1, column 10", "after 3 s");
}

TEST_F(SceneFileTest, WheelsAndDopplerAreAskedFor) {
  const SimulationOptions options = read(
      "faults = ['wheel-slip']\n[[lidar]]\ndoppler = true\n[wheels]\nuse = true\nrate = 20\n"
      "position = [0, 0, -1]\n");
  EXPECT_TRUE(options.wheels);
  EXPECT_EQ(options.wheel_rate, 20);
  EXPECT_EQ(options.T_imu_wheels.translation(), Eigen::Vector3d(0.0, 0.0, -1.0));
  EXPECT_TRUE(options.lidars.front().doppler);
  expect_refused("faults = ['wheel-slip']\n", "line 1, column 10", "there are none");
  expect_refused("[wheels]\nuse = 1\n", "line 2, column 7", "neither true nor false");
  expect_refused("[wheels]\nuse = true\nrate = 3\n", "line 3, column 8", "a divisor of 1e9");
  expect_refused("[wheels]\nradius = 3\n", "line 2, column 1", "no key 'radius'");
}

TEST_F(SceneFileTest, AWayHasADirectionEverywhere) {
  const auto expect_way_refused = [&](const std::string& corners, const std::string& part) {
    expect_refused("[trajectory]\nwaypoints = [" + corners + "]\n", "line 2, column 13", part);
  };
  expect_way_refused("[0, 0, 0], [9, 0, 0]", "at least three corners");
  expect_way_refused("[0, 0, 0], [0, 0, 0], [9, 0, 0], [9, 9, 0]", "the same place, 1 and 2");
  expect_way_refused("[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 0, 0]", "the way closes by itself");
  expect_way_refused("[0, 0, 0], [0, 0, 9], [9, 0, 0]", "the same place, 1 and 2");
  expect_way_refused("[0, 0, 0], [9, 0, 0], [4, 0, 0]", "turns straight back at corner 1");
  expect_way_refused("[0, 0, 0], [4, 3, 0], [9, 3, 0], [5, 3, 0]", "straight back at corner 3");
  const SimulationOptions far =
      read("[trajectory]\nwaypoints = [[0, 0, 0], [1e6, 0, 0], [1e6, 1e6, 0]]\n");
  EXPECT_EQ(far.waypoints.size(), 3U);
}

TEST_F(SceneFileTest, TwoSensorsOnAWayOfOnesOwn) {
  const auto file = folder_.write("two.toml", R"(
scene = "room"
duration = 1.0
[trajectory]
style = "moving-start"
speed = 1.0
waypoints = [[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]]
corner_radius = 0.5
[[lidar]]
sensor = "VLP-16"
topic = "/front"
frame = "front"
position = [0.5, 0.0, 0.2]
yaw_pitch_roll = [0, 20, 0]
noise = false
mixed_pixels = false
[[lidar]]
sensor = "VLP-16"
topic = "/rear"
frame = "rear"
position = [-0.5, 0.0, 0.2]
yaw_pitch_roll = [180, 0, 0]
[imu]
model = "none"
)");
  SimulateCommandOptions command{.simulation = {}, .layout = {}, .quiet = true};
  command.simulation.scene = file.string();
  command.simulation.output = folder_ / "two.mcap";
  command.simulation.picture = false;
  std::ostringstream out;
  std::ostringstream err;
  ASSERT_EQ(simulate_command(command, out, err), 0) << err.str();

  const auto recording = open_recording(command.simulation.output);
  std::map<std::string, int> sweeps;
  std::map<std::string, Eigen::Isometry3d> mounts;
  const auto events = recording->events({});
  while (const auto event = events->next()) {
    if (std::holds_alternative<Sweep>(event->value)) {
      ++sweeps[event->frame];
    } else if (const auto* mount = std::get_if<StaticTransform>(&event->value)) {
      mounts[mount->child] = mount->T_parent_child;
    }
  }
  EXPECT_EQ(sweeps, (std::map<std::string, int>{{"front", 10}, {"rear", 10}}));
  ASSERT_EQ(mounts.size(), 2U);
  const double pitch = 20.0 * std::numbers::pi / 180.0;
  EXPECT_TRUE(mounts["front"].linear().isApprox(
      Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()).toRotationMatrix(), 1e-12));
  EXPECT_NEAR(mounts["rear"].linear()(0, 0), -1.0, 1e-12);

  // The truth is that of the first sensor, ahead of the IMU, which comes down to the first corner.
  const Trajectory truth = read_trajectory(SimulationFiles(command.simulation.output).trajectory);
  const Eigen::Isometry3d& begin = truth.poses.front().pose;
  EXPECT_NEAR(begin.translation().x(), -2.0, 0.2);
  EXPECT_NEAR(begin.translation().y(), -1.5 - 0.5, 0.1);
  EXPECT_NEAR(begin.translation().z(), 1.3 + 0.2, 0.05);
  EXPECT_NEAR(begin.linear()(2, 0), -std::sin(pitch), 0.02) << "it looks down";

  command.besides_scene_file = "--sensor";
  EXPECT_EQ(simulate_command(command, out, err), 2);
  EXPECT_NE(err.str().find("--sensor: the scene file says all"), std::string::npos) << err.str();
}

}  // namespace
}  // namespace adit
