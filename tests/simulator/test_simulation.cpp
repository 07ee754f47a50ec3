// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/simulation.hpp"

#include <cstddef>
#include <fstream>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_simulate.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/simulator/motion.hpp"

namespace adit {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

constexpr uint64_t kNothing = 0xcbf29ce484222325U;

/// The FNV-1a sum of bytes, after those of `before`.
uint64_t sum_of(const void* data, std::size_t size, uint64_t before = kNothing) {
  for (std::size_t i = 0; i < size; ++i) {
    before = (before ^ static_cast<const uint8_t*>(data)[i]) * 0x100000001b3U;
  }
  return before;
}

uint64_t sum_of(const std::string& bytes) {
  return sum_of(bytes.data(), bytes.size());
}

/// Sum over the messages: the file also names the program's version.
uint64_t sum_of_messages(const std::filesystem::path& recording) {
  uint64_t sum = kNothing;
  for (const auto& file : open_message_files(recording)) {
    const auto messages = file->messages({});
    while (const auto message = messages->next()) {
      sum = sum_of(message->bytes.data(), message->bytes.size(), sum);
    }
  }
  return sum;
}

class SimulationTest : public testing::Test {
 protected:
  SimulationOptions options(const std::string& name) const {
    SimulationOptions options;
    options.scene = "room";
    options.trajectory = "moving-start";
    options.duration = 0.5;
    options.picture = false;
    options.output = folder_.path() / (name + ".mcap");
    return options;
  }

  test::TemporaryFolder folder_;
};

TEST_F(SimulationTest, TheSameSeedGivesTheSameBytesOnAnyMachine) {
  const SimulationOptions simulation = options("a");
  simulate(simulation, {});
  const SimulationFiles files(simulation.output);
  // Found on an x86-64 machine. Another value here means that recordings have changed: if that is
  // meant, put the new one in and raise kSimulatorRevision; if only this machine has it, what it
  // computes is not repeatable.
  EXPECT_EQ(sum_of_messages(files.recording), 13099163688924768574U);
  EXPECT_EQ(sum_of(content(files.trajectory)), 11951816956124405231U);
  EXPECT_EQ(sum_of(content(files.scene)), 9258612878955424420U);
  SimulationOptions other = options("b");
  simulate(other, {});
  EXPECT_EQ(content(files.recording), content(other.output));
  other.seed = 2;
  simulate(other, {});
  EXPECT_NE(content(files.recording), content(other.output));
}

TEST_F(SimulationTest, ACheckpointEndsItAnywhereAndChangesNoByte) {
  struct Stop {};
  SimulationOptions simulation = options("a");
  simulation.picture = true;
  simulation.cameras = {camera_named("front")};
  simulate(simulation, {});
  simulation.output = options("b").output;
  std::size_t passed = 0;
  const auto began = std::this_thread::get_id();
  simulate(simulation, {}, [&] {
    EXPECT_EQ(std::this_thread::get_id(), began) << "where Python has its signals";
    ++passed;
  });
  EXPECT_EQ(content(options("a").output), content(simulation.output));
  // How many pieces this thread takes differs from time to time: less than half is certain.
  for (const double share : {0.0, 0.1, 0.2, 0.4}) {
    auto left = static_cast<std::size_t>(share * static_cast<double>(passed));
    EXPECT_THROW(simulate(simulation, {},
                          [&] {
                            if (left-- == 0) {
                              throw Stop{};
                            }
                          }),
                 Stop)
        << share;
  }
  simulate(simulation, {});
  EXPECT_EQ(content(options("a").output), content(simulation.output));
}

TEST_F(SimulationTest, TheSamePlaceIsRecordedAgainLaterWithOtherErrors) {
  SimulationOptions first = options("first");
  first.noise_seed = first.seed;
  simulate(first, {});
  SimulationOptions again = options("again");
  simulate(again, {});
  EXPECT_EQ(content(first.output), content(again.output)) << "the seed is that of the errors";
  again.noise_seed = 7;
  again.later = 600.0;
  simulate(again, {});
  EXPECT_EQ(content(SimulationFiles(first.output).scene),
            content(SimulationFiles(again.output).scene));
  EXPECT_NE(content(first.output), content(again.output));
  const Trajectory before = read_trajectory(SimulationFiles(first.output).trajectory);
  const Trajectory after = read_trajectory(SimulationFiles(again.output).trajectory);
  ASSERT_EQ(before.poses.size(), after.poses.size());
  EXPECT_EQ(after.poses.front().stamp - before.poses.front().stamp, std::chrono::seconds(600));
  EXPECT_TRUE(after.poses.back().pose.isApprox(before.poses.back().pose));
  again.reverse = true;
  simulate(again, {});
  const Trajectory back = read_trajectory(SimulationFiles(again.output).trajectory);
  EXPECT_FALSE(back.poses.front().pose.isApprox(before.poses.front().pose));
  again.later = -1.0;
  EXPECT_THROW(simulate(again, {}), UsageError);
}

TEST_F(SimulationTest, TheRecordingHoldsWhatWasSimulated) {
  const SimulationOptions simulation = options("drive");
  const SimulationSummary summary = simulate(simulation, {});
  const auto recording = open_recording(simulation.output);
  const auto events = recording->events({});
  std::size_t sweeps = 0;
  std::size_t points = 0;
  std::size_t imu = 0;
  Nanoseconds received{0};
  while (const auto event = events->next()) {
    EXPECT_GE(event->received, received);
    received = event->received;
    if (const auto* sweep = std::get_if<Sweep>(&event->value)) {
      const Nanoseconds start =
          kSimulationEpoch + std::chrono::milliseconds(100) * static_cast<int>(sweeps);
      EXPECT_GE(sweep->stamp, start);
      EXPECT_LT(sweep->stamp, start + std::chrono::microseconds(60));
      EXPECT_EQ(sweep->rings.size(), sweep->points.size());
      EXPECT_EQ(sweep->times.size(), sweep->points.size());
      ++sweeps;
      points += sweep->points.size();
    } else if (const auto* sample = std::get_if<ImuSample>(&event->value)) {
      EXPECT_EQ(sample->stamp,
                kSimulationEpoch + std::chrono::milliseconds(5) * static_cast<int>(imu));
      ++imu;
    } else if (const auto* mount = std::get_if<StaticTransform>(&event->value)) {
      EXPECT_EQ(mount->parent, "imu");
      EXPECT_TRUE(mount->T_parent_child.isApprox(lidar_mount()));
    }
  }
  EXPECT_EQ(sweeps, 5U);
  EXPECT_EQ(sweeps, summary.sweeps);
  EXPECT_EQ(points, summary.points);
  EXPECT_EQ(imu, 100U);
  const Trajectory truth = read_trajectory(SimulationFiles(simulation.output).trajectory);
  ASSERT_EQ(truth.poses.size(), 100U);
  const SplineTrajectory motion =
      make_trajectory(make_scene("room", 1), motion_named("moving-start"), 1.0);
  EXPECT_TRUE(truth.poses[40].pose.isApprox(motion.pose(0.2) * lidar_mount(), 1e-9));
}

TEST_F(SimulationTest, EveryDriversLayoutIsReadBackAsTheSamePoints) {
  std::vector<std::vector<Point>> sweeps;
  std::vector<std::vector<float>> times;
  for (const CloudLayout layout :
       {CloudLayout::velodyne, CloudLayout::hesai, CloudLayout::ouster, CloudLayout::livox}) {
    SimulationOptions simulation = options(std::string(to_string(layout)));
    simulation.duration = 0.2;
    simulation.lidars.front().layout = layout;
    simulate(simulation, {});
    const auto recording = open_recording(simulation.output);
    const auto events =
        recording->events({.topics = {sweep_topic(*recording, simulation.output, {})}});
    const Sweep sweep = std::get<Sweep>(events->next()->value);
    std::vector<Point> returns;
    std::vector<float> stamps;
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      if (sweep.points[i].x != 0.0F) {
        returns.push_back(sweep.points[i]);
        stamps.push_back(sweep.times[i]);
      }
    }
    sweeps.push_back(returns);
    times.push_back(stamps);
  }
  for (const std::size_t other : {1U, 3U}) {
    ASSERT_EQ(sweeps[0].size(), sweeps[other].size());
    for (std::size_t i = 0; i < sweeps[0].size(); ++i) {
      EXPECT_EQ(sweeps[0][i].x, sweeps[other][i].x);
      EXPECT_EQ(sweeps[0][i].intensity, sweeps[other][i].intensity);
      EXPECT_NEAR(times[0][i], times[other][i], 1e-6);
    }
  }
  EXPECT_EQ(sweeps[0].size(), sweeps[2].size()) << "an organised cloud has another order";
}

TEST_F(SimulationTest, WhatMakesNoSenseIsRefused) {
  const auto code = [&](auto change) {
    SimulateCommandOptions command{.simulation = options("x"), .layout = {}};
    change(command);
    std::ostringstream out;
    std::ostringstream err;
    const int result = simulate_command(command, out, err);
    EXPECT_EQ(out.str(), "");
    EXPECT_FALSE(std::filesystem::exists(command.simulation.output));
    return std::pair(result, err.str());
  };
  const auto scene = code([](auto& command) { command.simulation.scene = "moon"; });
  EXPECT_EQ(scene.first, 2);
  EXPECT_NE(scene.second.find("there is no scene 'moon'"), std::string::npos) << scene.second;
  const auto sensor =
      code([](auto& command) { command.simulation.lidars.front().sensor = "VLP16"; });
  EXPECT_EQ(sensor.first, 2);
  EXPECT_NE(sensor.second.find("VLP-16"), std::string::npos) << "the nearest: " << sensor.second;
  EXPECT_EQ(code([](auto& command) { command.simulation.duration = -1; }).first, 2);
  EXPECT_EQ(code([](auto& command) { command.simulation.imu_rate = 7; }).first, 2);
  EXPECT_EQ(code([](auto& command) { command.layout = "sick"; }).first, 2);
  const auto of_none = code([](auto& command) {
    command.simulation.imu = "none";
    command.simulation.faults = {"nan", "gaps"};
  });
  EXPECT_NE(of_none.second.find("--fault: gaps is one of the IMU"), std::string::npos)
      << of_none.second;
  const auto shock = code([](auto& command) {
    command.simulation.duration = 3.0;
    command.simulation.faults = {"shock"};
  });
  EXPECT_NE(shock.second.find("the first blow comes after 3 s"), std::string::npos) << shock.second;
  const auto two = code([](auto& command) {
    command.simulation.faults = {"spikes", "many-spikes"};
  });
  EXPECT_NE(two.second.find("many-spikes and spikes exclude"), std::string::npos) << two.second;
  EXPECT_EQ(code([](auto& command) { command.simulation.output += ".bag"; }).first, 2);
}

TEST_F(SimulationTest, TheCommandTellsWhatItWrote) {
  SimulateCommandOptions command{.simulation = options("told"), .layout = {}, .perfect = true};
  command.simulation.imu = "none";
  command.simulation.picture = true;
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(simulate_command(command, out, err), 0) << err.str();
  const SimulationFiles files(command.simulation.output);
  for (const auto& file :
       {files.recording, files.trajectory, files.states, files.scene, files.picture, files.sweep}) {
    EXPECT_TRUE(std::filesystem::exists(file)) << file;
    EXPECT_NE(out.str().find(file.filename().string()), std::string::npos) << out.str();
  }
  const std::unique_ptr<Recording> recording = open_recording(files.recording);
  for (const Topic& topic : recording->topics()) {
    EXPECT_NE(topic.kind, TopicKind::imu);
  }
}

}  // namespace
}  // namespace adit
