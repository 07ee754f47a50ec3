// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit run` takes for the mounting of a recording's IMU, and what it says of it.
#include <filesystem>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/recordings/ros_events.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

class RunWithImu : public testing::Test {
 protected:
  /// Three sweeps and the readings of an IMU at rest; with a transform between them where `told`.
  fs::path record(bool told) {
    const auto folder = test::small_recording(folder_ / "sweeps", 3).recording;
    fs::path file = folder_ / (told ? "told.mcap" : "untold.mcap");
    McapWriter writer(file, {});
    const auto add = [&](const char* topic, const char* type) {
      return writer.add_channel({.topic = topic,
                                 .type = type,
                                 .encoding = Encoding::cdr,
                                 .definition = {},
                                 .messages = std::nullopt});
    };
    const std::size_t sweeps = add("/points", "sensor_msgs/PointCloud2");
    const std::size_t imu = add("/imu", "sensor_msgs/Imu");
    const std::size_t transforms = add("/tf_static", "tf2_msgs/TFMessage");
    const auto write = [&](std::size_t channel, Nanoseconds at, const EventValue& value,
                           const char* frame) {
      writer.write(channel, at, ros::from_event(value, Encoding::cdr, frame).bytes);
    };
    const auto recording = open_recording(folder);
    const auto events = recording->events({});
    bool first = true;
    while (const std::optional<Event> event = events->next()) {
      if (first && told) {
        StaticTransform mounting{"imu", "lidar", Eigen::Isometry3d::Identity()};
        mounting.T_parent_child.translation() << 0.25, 0.0, 0.5;
        write(transforms, event->received, mounting, "imu");
      }
      first = false;
      write(sweeps, event->received, event->value, "lidar");
      for (int i = 0; i < 10; ++i) {
        ImuSample reading;
        reading.stamp = std::get<Sweep>(event->value).stamp + std::chrono::milliseconds(10 * i);
        reading.linear_acceleration << 0.0, 0.0, 9.81;
        write(imu, event->received, reading, "imu");
      }
    }
    writer.close();
    return file;
  }

  /// What run says; the mounting it used is in mounting_.
  std::string run(const fs::path& recording, std::vector<std::string> overrides) {
    RunCommandOptions options;
    options.recording = recording;
    options.output = folder_ / "out";
    options.overwrite = true;
    options.config.overrides = std::move(overrides);
    std::ostringstream printed;
    std::ostringstream said;
    EXPECT_EQ(run_command(options, printed, said), 0) << said.str();
    mounting_ =
        test::json_of(options.output / "summary.json")["configuration"]["imu"]["T_imu_lidar"];
    return said.str();
  }

  static constexpr const char* kNote = "how the IMU is mounted is not told";
  test::TemporaryFolder folder_;
  nlohmann::json mounting_;
};

TEST_F(RunWithImu, SaysThatNothingTellsTheMounting) {
  const std::string said = run(record(false), {});
  EXPECT_NE(said.find(kNote), std::string::npos) << said;
  EXPECT_EQ(mounting_, nlohmann::json({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}));
}

TEST_F(RunWithImu, TakesTheMountingOfTheRecordingsTransforms) {
  const std::string said = run(record(true), {});
  EXPECT_EQ(said.find(kNote), std::string::npos) << said;
  EXPECT_EQ(mounting_, nlohmann::json({0.25, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0}));
}

TEST_F(RunWithImu, SettingsGoBeforeTransformsAndTheNoteIsOnlyForAnImuInUse) {
  std::string said = run(record(true), {"imu.T_imu_lidar=[0, 0, 1, 0, 0, 0, 1]"});
  EXPECT_EQ(said.find(kNote), std::string::npos) << said;
  EXPECT_EQ(mounting_, nlohmann::json({0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}));
  said = run(record(false), {"imu.use=0"});
  EXPECT_EQ(said.find(kNote), std::string::npos) << said;
}

}  // namespace
}  // namespace adit
