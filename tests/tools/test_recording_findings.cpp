// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/recording_findings.hpp"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace adit {
namespace {

std::vector<std::string> kinds(const std::vector<Topic>& topics) {
  std::vector<std::string> kinds;
  for (const Finding& finding : find_in_recording(topics)) {
    kinds.push_back(finding.kind);
  }
  return kinds;
}

TEST(RecordingFindings, DepthImagesThatAreNoSweepsAreNamed) {
  const Topic points{"/points", "sensor_msgs/PointCloud2", TopicKind::sweeps, 1};
  const Topic packed{"/depth/image_raw/compressedDepth", "sensor_msgs/CompressedImage",
                     TopicKind::other, 1};
  const Topic bare{"/depth/image_raw", "sensor_msgs/Image", TopicKind::other, 1};
  const Topic read{"/depth/image_raw", "sensor_msgs/Image", TopicKind::sweeps, 1};
  const Topic colours{"/color/image_raw", "sensor_msgs/Image", TopicKind::other, 1};
  EXPECT_EQ(kinds({points, packed}), std::vector<std::string>{"compressed_depth"});
  EXPECT_EQ(kinds({points, bare}), std::vector<std::string>{"depth_without_camera"});
  EXPECT_EQ(kinds({packed}), (std::vector<std::string>{"no_sweeps", "compressed_depth"}));
  EXPECT_TRUE(kinds({read, colours}).empty());
}

TEST(RecordingFindings, TopicsWithoutASweepAreAProblemUnlessAnotherHasSome) {
  const Topic none{"/points", "sensor_msgs/PointCloud2", TopicKind::sweeps, 0};
  const Topic some{"/rear", "sensor_msgs/PointCloud2", TopicKind::sweeps, 1};
  const std::vector<Finding> found = find_in_recording({none});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].severity, Severity::problem);
  EXPECT_EQ(found[0].topic + " " + found[0].kind, "/points no_sweeps");
  EXPECT_TRUE(kinds({none, some}).empty());
}

std::vector<Finding> found_of(const std::vector<int>& stamps_ms) {
  const Topic topic{"/points", "sensor_msgs/PointCloud2", TopicKind::sweeps, stamps_ms.size()};
  TopicStatistics statistics;
  for (const int ms : stamps_ms) {
    Sweep sweep;
    sweep.stamp = std::chrono::milliseconds(ms);
    sweep.points = {{1.0F, 0.0F, 0.0F, 0.0F}};
    sweep.times = {0.0F};
    statistics.add({.topic = 0, .received = sweep.stamp, .value = std::move(sweep)});
  }
  return find_in_topic(topic, statistics, {});
}

TEST(RecordingFindings, PointsThatAllHaveOneTimeAreNamed) {
  const Topic topic{"/points", "sensor_msgs/PointCloud2", TopicKind::sweeps, 5};
  const auto kinds_with = [&](float last) {
    TopicStatistics statistics;
    for (int i = 0; i < 5; ++i) {
      Sweep sweep;
      sweep.stamp = std::chrono::milliseconds(100 * i);
      sweep.points = {{1.0F, 0.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F, 0.0F}};
      sweep.times = {0.0F, last};
      statistics.add({.topic = 0, .received = sweep.stamp, .value = std::move(sweep)});
    }
    std::vector<std::string> kinds;
    for (const Finding& finding : find_in_topic(topic, statistics, {})) {
      kinds.push_back(finding.kind);
    }
    return kinds;
  };
  EXPECT_EQ(kinds_with(0.0F), std::vector<std::string>{"no_point_times"});
  EXPECT_TRUE(kinds_with(0.09F).empty());
}

TEST(RecordingFindings, AGapIsFoundAmongFewSweepsToo) {
  EXPECT_TRUE(found_of({0, 100, 200, 300, 400}).empty());
  const std::vector<Finding> found = found_of({0, 100, 200, 29900, 30000});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, "gaps");
  EXPECT_NE(found[0].found.find("1 gap, the longest of 29.700 s"), std::string::npos)
      << found[0].found;
  EXPECT_TRUE(found_of({0, 100, 29900}).empty()) << "nothing tells which of the two is usual";
}

TEST(RecordingFindings, EmptySweepsAreCountedAndTheOthersJudged) {
  const Topic topic{"/points", "sensor_msgs/PointCloud2", TopicKind::sweeps, 100};
  TopicStatistics statistics;
  for (int i = 0; i < 100; ++i) {
    Sweep sweep;
    sweep.stamp = std::chrono::milliseconds(100 * i);
    if (i % 10 != 5) {
      sweep.points = {{1.0F, 0.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F, 0.0F}};
      sweep.times = {0.0F, 0.09F};
      sweep.rings = {0, 1};
    }
    statistics.add({.topic = 0, .received = sweep.stamp, .value = std::move(sweep)});
  }
  const std::vector<Finding> found = find_in_topic(topic, statistics, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].found, "10 of 100 sweeps are empty: no return");
  EXPECT_EQ(statistics.sweeps.with_rings, statistics.with_points());
}

/// 100 readings at 100 Hz of a sensor that turns; the stamps are as `stamp` says, s after 1970.
std::vector<Finding> found_of_imu(const std::function<double(int)>& stamp, double scale = 1.0,
                                  const OtherTopics& others = {}) {
  const Topic topic{"/imu", "sensor_msgs/Imu", TopicKind::imu, 100};
  TopicStatistics statistics;
  for (int i = 0; i < 100; ++i) {
    const double wave = std::sin(0.1 * i);
    const ImuSample sample{
        .stamp = nanoseconds(stamp(i)),
        .angular_velocity = {0.5 * wave, 0.3 * std::cos(0.07 * i), 0.2 + 0.1 * wave},
        .linear_acceleration = scale * Eigen::Vector3d(0.5 * wave, 0.2 * std::cos(0.1 * i), 9.8)};
    const Nanoseconds received = nanoseconds(1.7e9) + std::chrono::milliseconds(10 * i);
    statistics.add({.topic = 0, .received = received, .value = sample});
  }
  return find_in_topic(topic, statistics, {}, others);
}

TEST(RecordingFindings, ARestartOfTheClockIsNamedWithItsPlaceAndNothingElseOfIt) {
  const auto found =
      found_of_imu([](int i) { return i < 50 ? 1.7e9 + 0.01 * i : 12.0 + 0.01 * (i - 50); });
  ASSERT_EQ(found.size(), 1U) << found[1].found;
  EXPECT_EQ(found[0].kind, "clock_restart");
  EXPECT_EQ(found[0].severity, Severity::problem);
  EXPECT_EQ(found[0].found,
            "its clock restarts 0.500 s after its first message: it falls back by 1699999988.500 s "
            "and counts on from 12.000 s");
}

TEST(RecordingFindings, AnUnknownLeapOfTheClockIsNamedToo) {
  const auto found = found_of_imu([](int i) { return 1.7e9 + 0.01 * i + (i < 50 ? 0.0 : 5.0); });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, "clock_leap");
  EXPECT_EQ(found[0].found,
            "its clock leaps by 5.000 s against the recorder's 0.500 s after its first message");
}

TEST(RecordingFindings, WhatARunMakesUpForIsNoProblem) {
  const auto usual = [](int i) { return 1.7e9 + 0.01 * i; };
  EXPECT_TRUE(found_of_imu(usual).empty());
  const auto in_g = found_of_imu(usual, 1.0 / 9.80665);
  ASSERT_EQ(in_g.size(), 1U);
  EXPECT_EQ(in_g[0].kind, "accelerometer_unit");
  EXPECT_EQ(in_g[0].severity, Severity::notice);
  EXPECT_EQ(in_g[0].effect, "handled automatically: the start of the IMU finds the unit");
  const auto twice = found_of_imu([&](int i) { return usual(i / 2 * 2); });
  ASSERT_EQ(twice.size(), 1U);
  EXPECT_EQ(twice[0].kind, "repeated_stamps");
  EXPECT_EQ(twice[0].severity, Severity::notice);
  const auto stands = found_of_imu([&](int i) { return usual(i / 4 * 4); });
  EXPECT_EQ(stands.at(0).severity, Severity::problem) << "three of four readings are lost";
  const auto swapped = found_of_imu([&](int i) { return usual(i == 40 ? 41 : i == 41 ? 40 : i); });
  ASSERT_EQ(swapped.size(), 1U);
  EXPECT_EQ(swapped[0].kind, "stamps_go_back");
  EXPECT_EQ(swapped[0].severity, Severity::notice);
}

TEST(RecordingFindings, AnOffsetThatAllSensorsShareDoesNoHarm) {
  const auto since_start = [](int i) { return 12.0 + 0.01 * i; };
  const auto alone = found_of_imu(since_start);
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_EQ(alone[0].severity, Severity::problem);
  const auto shared = found_of_imu(since_start, 1.0, {.shared_clock = true});
  ASSERT_EQ(shared.size(), 1U);
  EXPECT_EQ(shared[0].kind, "clock_offset");
  EXPECT_EQ(shared[0].severity, Severity::notice);
  TopicStatistics early;
  TopicStatistics late;
  early.add({.topic = 0, .received = std::chrono::seconds(100), .value = ImuSample{}});
  late.add({.topic = 1,
            .received = std::chrono::seconds(100),
            .value = ImuSample{.stamp = std::chrono::seconds(60)}});
  const std::vector<Topic> topics = {{"/a", "", TopicKind::imu, 1}, {"/b", "", TopicKind::imu, 1}};
  EXPECT_TRUE(share_a_clock(topics, {early, early}, {true, true}));
  EXPECT_FALSE(share_a_clock(topics, {early, late}, {true, true}));
  EXPECT_TRUE(share_a_clock(topics, {early, late}, {true, false}));
}

TEST(RecordingFindings, GravityAlongMinusZIsAFaultOnlyInBothFrames) {
  const Topic topic{"/imu", "sensor_msgs/Imu", TopicKind::imu, 100};
  TopicStatistics statistics;
  for (int i = 0; i < 100; ++i) {
    const Nanoseconds at = std::chrono::milliseconds(10 * i);
    statistics.add({.topic = 0,
                    .received = at,
                    .value = ImuSample{.stamp = at,
                                       .angular_velocity = {0.1 * std::sin(0.1 * i),
                                                            0.1 * std::cos(0.1 * i), 0.01 * i},
                                       .linear_acceleration = {0.1 * std::sin(0.1 * i),
                                                               0.1 * std::cos(0.2 * i), -9.8}},
                    .frame = "imu"});
  }
  StaticTransform mounting{"imu", "lidar", Eigen::Isometry3d::Identity()};
  const auto kinds_with = [&] {
    FrameTree frames;
    frames.add(mounting);
    return find_in_topic(topic, statistics, frames, {.range_frame = "lidar"});
  };
  ASSERT_EQ(kinds_with().size(), 1U);
  EXPECT_EQ(kinds_with()[0].kind, "gravity_direction");
  mounting.T_parent_child.linear() = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  EXPECT_TRUE(kinds_with().empty()) << "the IMU hangs upside down below an upright lidar";
}

}  // namespace
}  // namespace adit
