// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Cameras in the recordings that `adit simulate` writes.
#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_simulate.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/recordings/ros_visit.hpp"
#include "adit/tools/simulator/camera_simulator.hpp"
#include "adit/tools/simulator/faults.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// What the messages of a recording's cameras say.
struct CameraMessages {
  std::map<std::string, std::vector<SimulatedImage>> images{};  ///< by frame
  std::map<std::string, ros::CameraInfo> infos{};               ///< the last one
  std::map<std::string, Eigen::Isometry3d> mounts{};
  std::vector<Nanoseconds> received{};
  std::size_t info_count = 0;
};

CameraMessages read_camera_messages(const std::filesystem::path& recording) {
  CameraMessages read;
  for (const auto& file : open_message_files(recording)) {
    const auto messages = file->messages({});
    while (const auto message = messages->next()) {
      const Channel& channel = file->channels()[message->channel];
      if (channel.type == ros::Image::kType) {
        const auto image = ros::decode<ros::Image>(channel.encoding, message->bytes);
        EXPECT_EQ(channel.topic, "/" + image.header.frame + "/image_raw");
        EXPECT_EQ(image.encoding, "rgb8");
        EXPECT_EQ(image.step, 3 * image.width);
        SimulatedImage& kept = read.images[image.header.frame].emplace_back();
        kept.stamp = image.header.stamp;
        kept.image = {.width = image.width, .height = image.height};
        for (const std::byte part : image.data) {
          kept.image.rgb.push_back(static_cast<uint8_t>(part));
        }
        read.received.push_back(message->received);
      } else if (channel.type == ros::CameraInfo::kType) {
        const auto info = ros::decode<ros::CameraInfo>(channel.encoding, message->bytes);
        EXPECT_EQ(channel.topic, "/" + info.header.frame + "/camera_info");
        read.infos[info.header.frame] = info;
        ++read.info_count;
      }
    }
  }
  const auto opened = open_recording(recording);
  const auto events = opened->events({});
  while (const auto event = events->next()) {
    if (const auto* mount = std::get_if<StaticTransform>(&event->value)) {
      EXPECT_EQ(mount->parent, "imu");
      read.mounts[mount->child] = mount->T_parent_child;
    }
  }
  return read;
}

std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The FNV-1a sum of all images.
uint64_t sum_of_images(const CameraMessages& messages) {
  uint64_t sum = 0xcbf29ce484222325U;
  for (const auto& [frame, images] : messages.images) {
    for (const SimulatedImage& image : images) {
      for (const uint8_t part : image.image.rgb) {
        sum = (sum ^ part) * 0x100000001b3U;
      }
    }
  }
  return sum;
}

class SimulatedCamerasTest : public testing::Test {
 protected:
  SimulationOptions options(const std::string& name) const {
    SimulationOptions options;
    options.scene = "room";
    options.trajectory = "moving-start";
    options.duration = 0.6;
    options.picture = false;
    options.cameras = {camera_named("front"), camera_named("left:fisheye")};
    options.output = folder_.path() / (name + ".mcap");
    return options;
  }

  test::TemporaryFolder folder_;
};

TEST_F(SimulatedCamerasTest, TheRecordingHoldsImagesCalibrationsAndMounts) {
  const SimulationOptions simulation = options("a");
  EXPECT_EQ(simulate(simulation, {}).images, 4U);
  const CameraMessages read = read_camera_messages(simulation.output);
  EXPECT_EQ(read.info_count, 4U);
  const Scene scene = make_scene("room", 1);
  const SceneCaster caster(scene);
  const SplineTrajectory motion = make_trajectory(scene, motion_named("moving-start"), 1.1);
  for (const CameraOptions& options : simulation.cameras) {
    const CameraModel model = camera_lens(options.lens);
    ASSERT_EQ(read.images.at(options.frame()).size(), 2U);
    const SimulatedImage& second = read.images.at(options.frame())[1];
    EXPECT_EQ(second.stamp, kSimulationEpoch + std::chrono::milliseconds(500));
    EXPECT_EQ(second.image.width, model.width);
    EXPECT_EQ(second.image.height, model.height);
    const CameraSimulator camera(caster, model,
                                 {.trajectory = &motion, .T_body_camera = options.T_imu_camera}, 1);
    EXPECT_EQ(second.image.rgb, camera.image(0.5).rgb) << options.name;
    EXPECT_TRUE(read.mounts.at(options.frame()).isApprox(options.T_imu_camera, 1e-12));
    const ros::CameraInfo& info = read.infos.at(options.frame());
    EXPECT_EQ(info.width, model.width);
    EXPECT_EQ(info.height, model.height);
    EXPECT_EQ(info.k, (std::array<double, 9>{model.fx, 0.0, model.cx, 0.0, model.fy, model.cy, 0.0,
                                             0.0, 1.0}));
    const bool fisheye = options.lens == "fisheye";
    EXPECT_EQ(info.distortion_model, fisheye ? "equidistant" : "plumb_bob");
    ASSERT_EQ(info.d.size(), fisheye ? 4U : 5U);
    EXPECT_TRUE(std::equal(info.d.begin(), info.d.end(), model.distortion.begin()));
    EXPECT_NE(info.d[0], 0.0);
  }
}

TEST_F(SimulatedCamerasTest, TheSameSeedGivesTheSameBytesOnAnyMachine) {
  SimulationOptions simulation = options("a");
  simulate(simulation, {});
  // Found on an x86-64 machine, as those of the simulation without cameras.
  EXPECT_EQ(sum_of_images(read_camera_messages(simulation.output)), 5602212308311371246U);
  SimulationOptions other = options("b");
  other.noise_seed = 5;
  simulate(other, {});
  EXPECT_EQ(sum_of_images(read_camera_messages(other.output)),
            sum_of_images(read_camera_messages(simulation.output)))
      << "the place and its colours are the same";
  other.seed = 2;
  simulate(other, {});
  EXPECT_NE(sum_of_images(read_camera_messages(other.output)),
            sum_of_images(read_camera_messages(simulation.output)));
}

TEST_F(SimulatedCamerasTest, EachReturnHasATrueColourWhereThereAreCameras) {
  SimulationOptions simulation = options("a");
  simulate(simulation, {});
  const SimulationFiles files(simulation.output);
  const std::string surfaces = file_bytes(files.surfaces);
  const std::string colors = file_bytes(files.colors);
  ASSERT_EQ(colors.size(), 3 * surfaces.size());
  ASSERT_GT(surfaces.size(), 10000U);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    EXPECT_EQ(colors.substr(3 * i, 3) == std::string(3, '\0'), surfaces[i] == '\0') << i;
  }
  simulation.cameras.clear();
  simulation.output = options("b").output;
  EXPECT_EQ(simulate(simulation, {}).images, 0U);
  EXPECT_FALSE(std::filesystem::exists(SimulationFiles(simulation.output).colors));
  EXPECT_EQ(file_bytes(SimulationFiles(simulation.output).surfaces), surfaces)
      << "cameras change nothing else";
}

TEST_F(SimulatedCamerasTest, FaultsTurnMountsAndDelayStampsOfRecordings) {
  SimulationOptions simulation = options("a");
  simulation.faults = {"camera-turned", "camera-late"};
  simulate(simulation, {});
  const CameraMessages read = read_camera_messages(simulation.output);
  for (const CameraOptions& options : simulation.cameras) {
    const Eigen::Isometry3d error =
        options.T_imu_camera.inverse() * read.mounts.at(options.frame());
    EXPECT_NEAR(so3_log(error.linear()).norm(), kDegree, 1e-9);
    EXPECT_GT(so3_log(error.linear()).cwiseAbs().minCoeff(), 0.3 * kDegree) << "of no axis alone";
    EXPECT_LT(error.translation().norm(), 1e-12);
    EXPECT_EQ(read.images.at(options.frame())[1].stamp,
              kSimulationEpoch + std::chrono::milliseconds(520));
  }
  EXPECT_EQ(read.received.back(), kSimulationEpoch + std::chrono::milliseconds(500));
}

TEST(CameraFaults, ExposureGoesUpAndDownByTwo) {
  const auto brightness_at = [](int milliseconds) {
    SimulatedImage image{.stamp = std::chrono::milliseconds(milliseconds),
                         .image = {.width = 1, .height = 1, .rgb = {100, 10, 200}}};
    FaultMaker({Fault::camera_exposure}, 20.0, 1).distort(image);
    return image.image.rgb;
  };
  EXPECT_EQ(brightness_at(0), (std::vector<uint8_t>{100, 10, 200}));
  EXPECT_EQ(brightness_at(2500), (std::vector<uint8_t>{200, 20, 255})) << "twice, at most white";
  EXPECT_EQ(brightness_at(7500), (std::vector<uint8_t>{50, 5, 100}));
  EXPECT_THROW(require_seen({"camera-exposure"}, 10.0, {}), UsageError);
  EXPECT_NO_THROW(require_seen({"camera-exposure"}, 10.0, {.camera = true}));
}

TEST_F(SimulatedCamerasTest, TheCommandTakesNamesAndLenses) {
  const auto run = [&](std::vector<std::string> cameras, std::optional<int> rate) {
    SimulateCommandOptions command{.simulation = options("c"),
                                   .layout = {},
                                   .cameras = std::move(cameras),
                                   .camera_rate = rate};
    command.simulation.cameras.clear();
    std::ostringstream out;
    std::ostringstream err;
    const int code = simulate_command(command, out, err);
    return std::pair(code, out.str() + err.str());
  };
  const auto taken = run({"back:fisheye", "front"}, 5);
  EXPECT_EQ(taken.first, 0) << taken.second;
  EXPECT_NE(taken.second.find("6 images (back fisheye 5 Hz, front perspective 5 Hz)"),
            std::string::npos)
      << taken.second;
  EXPECT_NE(taken.second.find("c.truth.colors"), std::string::npos) << taken.second;
  EXPECT_EQ(read_camera_messages(options("c").output).images.at("camera_back").size(), 3U);
  const auto unknown = run({"fron"}, std::nullopt);
  EXPECT_EQ(unknown.first, 2);
  EXPECT_NE(unknown.second.find("--camera: there is no camera 'fron'. The nearest valid name is "
                                "'front'"),
            std::string::npos)
      << unknown.second;
  EXPECT_NE(run({"front", "front"}, {}).second.find("two cameras 'front'"), std::string::npos);
  EXPECT_NE(run({"front"}, 7).second.find("must be a divisor of 1e9"), std::string::npos);
}

}  // namespace
}  // namespace adit
