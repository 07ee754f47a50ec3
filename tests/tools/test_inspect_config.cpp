// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit inspect --write-config`: what it writes makes up for what is wrong.
#include <cmath>

#include "adit/tests/tools/inspect_support.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/export/convert_recording.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using test::clean_recording;
using test::Kinds;
using test::MovingRig;
using test::Recorded;

namespace fs = std::filesystem;

struct Corrected {
  Kinds before;
  Kinds after;  ///< read with the configuration that was written
  Config config;
  std::string toml;
};

Corrected correct(const fs::path& file, const fs::path& toml) {
  std::ostringstream out;
  std::ostringstream err;
  InspectCommandOptions options;
  options.recording = file;
  options.write_config = toml;
  inspect_command(options, out, err);
  EXPECT_EQ(err.str(), "");
  return {test::kinds(file), test::kinds(file, {.file = toml, .overrides = {}}),
          load_config({.file = toml, .overrides = {}}), test::content(toml)};
}

/// Corrects the clean recording, spoilt.
Corrected correct(const std::function<void(Recorded&)>& spoil) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (Recorded& event : events) {
    spoil(event);
  }
  return correct(test::write(folder, events), folder / "drive.toml");
}

template <class Value>
auto on(const std::function<void(Value&)>& change) {
  return [change](Recorded& event) {
    if (auto* value = std::get_if<Value>(&event.value)) {
      change(*value);
    }
  };
}

TEST(InspectConfig, CleanRecordingGetsItsTopics) {
  const Corrected result = correct([](Recorded&) {});
  EXPECT_EQ(result.before, Kinds{});
  EXPECT_EQ(result.after, Kinds{});
  EXPECT_EQ(result.config.recording,
            (RecordingConfig{.sweep_topic = "/points", .imu_topic = "/imu"}));
  EXPECT_NE(result.toml.find("# /points: 7200 points a sweep"), std::string::npos) << result.toml;
  EXPECT_NE(result.toml.find("times in field 'time', unit 1 s, after the stamp"), std::string::npos)
      << result.toml;
}

Eigen::Quaterniond rotation_imu_lidar(const Config& config) {
  const std::array<double, 7> T = config.imu.T_imu_lidar.value_or(std::array<double, 7>{});
  return {T[6], T[3], T[4], T[5]};
}

TEST(InspectConfig, MountingByTheMotionWhereTheRecordingDoesNotTellIt) {
  const test::TemporaryFolder folder;
  MovingRig rig;
  rig.T_lidar_imu.linear() = so3_exp({0.5, -0.4, 1.9});
  std::vector<Recorded> events = rig.record();
  std::erase_if(events, [](const Recorded& event) { return event.topic == "/tf_static"; });
  const Corrected result = correct(test::write(folder, events), folder / "drive.toml");
  EXPECT_LT(rotation_imu_lidar(result.config)
                .angularDistance(Eigen::Quaterniond(rig.T_lidar_imu.linear()).inverse()),
            0.08);
}

TEST(InspectConfig, MountingByTheMotionWhereTheTransformIsWrong) {
  const Corrected result = correct(on<StaticTransform>([](StaticTransform& transform) {
    if (transform.child == "imu") {
      transform.T_parent_child.linear() = so3_exp({0.0, 0.0, 1.57});
    }
  }));
  EXPECT_EQ(result.before, Kinds{"mounting /imu"});
  EXPECT_EQ(result.after, Kinds{});
  EXPECT_LT(rotation_imu_lidar(result.config)
                .angularDistance(Eigen::Quaterniond(MovingRig{}.T_lidar_imu.linear()).inverse()),
            0.08);
  ASSERT_TRUE(result.config.imu.T_imu_lidar);
  EXPECT_NEAR((*result.config.imu.T_imu_lidar)[2], -MovingRig{}.T_lidar_imu.translation().z(),
              0.02);
}

TEST(InspectConfig, UnitsAndSigns) {
  const Corrected g =
      correct(on<ImuSample>([](ImuSample& imu) { imu.linear_acceleration /= 9.80665; }));
  EXPECT_EQ(g.before, Kinds{"accelerometer_unit /imu"});
  EXPECT_EQ(g.after, Kinds{});
  const Corrected flipped =
      correct(on<ImuSample>([](ImuSample& imu) { imu.linear_acceleration *= -1.0; }));
  EXPECT_EQ(flipped.before, Kinds{"gravity_direction /imu"});
  EXPECT_EQ(flipped.after, Kinds{});
  const Corrected degrees =
      correct(on<ImuSample>([](ImuSample& imu) { imu.angular_velocity *= 57.29578; }));
  EXPECT_EQ(degrees.before, Kinds{"gyroscope_unit /imu"});
  EXPECT_EQ(degrees.after, Kinds{});
}

TEST(InspectConfig, Clocks) {
  const Corrected late =
      correct(on<ImuSample>([](ImuSample& imu) { imu.stamp += std::chrono::milliseconds(100); }));
  EXPECT_EQ(late.before, Kinds{"sensor_offset /imu"});
  EXPECT_EQ(late.after, Kinds{});
  EXPECT_NEAR(late.config.recording.imu_time_offset, -0.1, 0.005);
  const Corrected leap =
      correct(on<Sweep>([](Sweep& sweep) { sweep.stamp += std::chrono::seconds(37); }));
  EXPECT_EQ(leap.before, Kinds{"clock_offset /points"});
  EXPECT_EQ(leap.after, Kinds{});
  EXPECT_EQ(leap.config.recording.sweep_time_offset, -37.0);
  const Corrected both = correct(on<ImuSample>(
      [](ImuSample& imu) { imu.stamp -= MovingRig::kBegin - std::chrono::milliseconds(12130); }));
  EXPECT_EQ(both.before, (Kinds{"clock_offset /imu", "sensor_offset /imu"}));
  EXPECT_EQ(both.after, Kinds{});
}

/// A sensor that takes two seconds for a sweep and tells the times of its points in milliseconds.
std::vector<Recorded> slow_sensor() {
  std::vector<Recorded> events;
  for (int i = 0; i < 8; ++i) {
    Sweep sweep = MovingRig{}.sweep(test::make_street(10.0), 0);
    sweep.stamp = MovingRig::kBegin + std::chrono::seconds(2 * i);
    for (float& time : sweep.times) {
      time *= 19990.0F;
    }
    const Nanoseconds received = sweep.stamp + std::chrono::milliseconds(900);
    events.push_back({"/points", received, std::move(sweep)});
  }
  return events;
}

TEST(InspectConfig, UnitOfThePointTimes) {
  const test::TemporaryFolder folder;
  const fs::path file = test::write(folder, slow_sensor());
  const Corrected result = correct(file, folder / "drive.toml");
  EXPECT_EQ(result.before, Kinds{"point_time_unit /points"});
  EXPECT_EQ(result.after, Kinds{});
  EXPECT_EQ(result.config.recording.point_time_unit, 1e-3);
}

TEST(InspectConfig, RunRefusesTimesItCannotUnderstandAndSaysWhatToSet) {
  const test::TemporaryFolder folder;
  const fs::path file = test::write(folder, slow_sensor());
  std::ostringstream out;
  std::ostringstream err;
  RunCommandOptions options;
  options.recording = file;
  options.output = folder / "out";
  options.count = 2;
  EXPECT_EQ(run_command(options, out, err), 1);
  EXPECT_NE(err.str().find("--set recording.point_time_unit=0.001 would fit"), std::string::npos)
      << err.str();
  EXPECT_FALSE(fs::exists(folder / "out"));
  options.config.overrides = {"recording.point_time_unit=0.001"};
  EXPECT_EQ(run_command(options, out, err), 0) << err.str();
}

TEST(InspectConfig, ConvertWritesTheRecordingAsItShouldHaveBeen) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (Recorded& event : events) {
    if (auto* imu = std::get_if<ImuSample>(&event.value)) {
      imu->stamp += std::chrono::milliseconds(100);
      imu->linear_acceleration /= 9.80665;
    }
  }
  const fs::path file = test::write(folder, events);
  const fs::path toml = folder / "drive.toml";
  const Corrected result = correct(file, toml);
  EXPECT_EQ(result.before, (Kinds{"accelerometer_unit /imu", "sensor_offset /imu"}));
  ConvertOptions options;
  options.input = file;
  options.overwrite = true;
  options.repair = load_config({.file = toml, .overrides = {}}).recording;
  for (const char* name : {"right.mcap", "right.bag"}) {
    options.output = folder / name;
    EXPECT_EQ(convert_recording(options).error_count, 0U);
    EXPECT_EQ(test::kinds(options.output), Kinds{}) << name;
  }
  const fs::path slow = test::write(folder, slow_sensor());
  options.input = slow;
  options.repair = RecordingConfig{.point_time_unit = 1e-3};
  convert_recording(options);
  EXPECT_EQ(test::kinds(options.output), Kinds{});
}

TEST(InspectConfig, NamesThatAreNoTextDoNotSpoilIt) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "dr\xe9.mcap";
  fs::rename(test::write(folder, clean_recording()), file);
  EXPECT_EQ(correct(file, folder / "drive.toml").after, Kinds{});
}

TEST(InspectConfig, TopicIsAText) {
  const Config config =
      load_config({.file = {}, .overrides = {"recording.sweep_topic=\"/points\""}});
  EXPECT_EQ(config.recording.sweep_topic, "/points");
  EXPECT_THROW(
      static_cast<void>(load_config({.file = {}, .overrides = {"recording.sweep_topic=7"}})),
      UsageError);
}

}  // namespace
}  // namespace adit
