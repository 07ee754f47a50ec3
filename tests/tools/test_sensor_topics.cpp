// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which IMU and receiver a run uses, and how it finds their mounting.
#include "adit/tools/setup/sensor_topics.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tests/recordings/event_support.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using test::GivenRecording;
using test::reading_event;
using test::sweep_event;

const Topic kPoints{"/points", "sensor_msgs/PointCloud2", TopicKind::sweeps, 1};
const Topic kStatic{"/tf_static", "tf2_msgs/TFMessage", TopicKind::transforms, {}};
const Topic kMoving{"/tf", "tf2_msgs/TFMessage", TopicKind::poses, {}};

Topic imu(const char* name, std::optional<uint64_t> messages = 100) {
  return {name, "sensor_msgs/Imu", TopicKind::imu, messages};
}

Event transform_event(std::size_t topic, int ms, const char* parent, const char* child,
                      double yaw = 0.0) {
  StaticTransform transform{parent, child, Eigen::Isometry3d::Identity()};
  transform.T_parent_child.linear() = so3_exp({0.0, 0.0, yaw});
  return {
      .topic = topic, .received = std::chrono::milliseconds(ms), .value = transform, .bytes = 100};
}

Event pose_event(std::size_t topic, int ms, const char* parent, const char* child, double x) {
  const Nanoseconds at = std::chrono::milliseconds(ms);
  ReferencePose pose{at, parent, child, Eigen::Isometry3d::Identity()};
  pose.T_parent_child.translation().x() = x;
  return {.topic = topic, .received = at, .value = pose, .bytes = 100};
}

/// A sweep of "lidar" on topic 0, and as many readings of each kind.
std::vector<Event> events_of(const std::vector<std::function<Event(int)>>& each) {
  std::vector<Event> events{sweep_event(0, 0, "lidar")};
  for (int i = 0; i < 100; ++i) {
    for (const auto& make : each) {
      events.push_back(make(i));
    }
  }
  std::ranges::stable_sort(events, {}, &Event::received);
  return events;
}

std::string text_of(const RecordedSensors& sensors, const Recording& recording) {
  std::string text = sensors.imu ? recording.topics()[*sensors.imu].name : "none";
  for (const PassedOver& one : sensors.passed_over) {
    text += "; " + describe(one);
  }
  return text;
}

std::string chosen_of(const std::vector<Topic>& topics, const std::vector<Event>& events,
                      const Config& config = {}) {
  const GivenRecording recording(topics, events);
  return text_of(choose_sensors(recording, 0, config), recording);
}

TEST(SensorTopics, AnImuWithoutMessagesIsPassedOver) {
  const auto events = events_of({[](int i) { return reading_event(2, 5 * i, "imu"); }});
  EXPECT_EQ(chosen_of({kPoints, imu("/camera/imu", 0), imu("/imu")}, events),
            "/imu; /camera/imu is not used: it has no messages");
  EXPECT_EQ(chosen_of({kPoints, imu("/camera/imu", std::nullopt), imu("/imu")}, events),
            "/imu; /camera/imu is not used: not one of its first messages can be read");
  EXPECT_EQ(chosen_of({kPoints, imu("/imu", 0)}, {sweep_event(0, 0, "lidar")}),
            "none; /imu is not used: it has no messages");
}

TEST(SensorTopics, AnImuOfZerosIsPassedOverButNotWhereItIsTheOnlyOne) {
  const auto zeros = [](int i) { return reading_event(1, 5 * i, "imu", 0.0); };
  const auto real = [](int i) { return reading_event(2, 5 * i, "imu"); };
  EXPECT_EQ(chosen_of({kPoints, imu("/zeros"), imu("/imu")}, events_of({zeros, real})),
            "/imu; /zeros is not used: its first 100 readings are all zero");
  EXPECT_EQ(chosen_of({kPoints, imu("/zeros")}, events_of({zeros})), "/zeros")
      << "the run says what is wrong with it";
}

TEST(SensorTopics, OfTwoImusTheOneThatTransformsConnectWithTheLidarIsChosen) {
  const auto phone = [](int i) { return reading_event(1, 2 * i, "phone"); };
  const auto mounted = [](int i) { return reading_event(2, 5 * i, "imu"); };
  std::vector<Event> events = events_of({phone, mounted});
  events.insert(events.begin(), transform_event(3, 0, "base", "lidar"));
  events.insert(events.begin(), transform_event(3, 0, "base", "imu"));
  const std::vector<Topic> topics = {kPoints, imu("/phone"), imu("/imu"), kStatic};
  EXPECT_EQ(chosen_of(topics, events),
            "/imu; /phone is not used: no transform connects its frame 'phone' with the range "
            "sensor's");
  Config named;
  named.recording.imu_topic = "/phone";
  EXPECT_EQ(chosen_of(topics, events, named), "/phone");
  named.recording.imu_topic = "/points";
  const GivenRecording recording(topics, events);
  try {
    choose_sensors(recording, 0, named);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("which has sensor_msgs/PointCloud2"),
              std::string::npos)
        << error.what();
  }
}

TEST(SensorTopics, OfTwoImusAlikeTheFasterIsChosenAndOfTwoAsFastTheFirst) {
  const auto every = [](std::size_t topic, int ms) {
    return [topic, ms](int i) { return reading_event(topic, ms * i, "imu"); };
  };
  const std::vector<Topic> topics = {kPoints, imu("/a"), imu("/b")};
  EXPECT_EQ(chosen_of(topics, events_of({every(1, 10), every(2, 5)})),
            "/b; /a is not used: its rate is 100 Hz, that of /b 200 Hz");
  EXPECT_EQ(chosen_of(topics, events_of({every(1, 5), every(2, 5)})),
            "/a; /b is not used: /a is as good");
}

TEST(SensorTopics, OfTwoImusOnOneTopicOneFrameIsUsed) {
  const auto a = [](int i) { return reading_event(1, 10 * i, "imu_a"); };
  const auto b = [](int i) { return reading_event(1, 5 * i + 1, "imu_b"); };
  const GivenRecording recording({kPoints, imu("/imu", 200)}, events_of({a, b}));
  const RecordedSensors sensors = choose_sensors(recording, 0, {});
  EXPECT_EQ(sensors.frames.at(1), "imu_b");
  EXPECT_EQ(sensors.frames.at(0), "lidar");
  Config named;
  named.recording.imu_frame = "/imu_a";
  EXPECT_EQ(choose_sensors(recording, 0, named).frames.at(1), "imu_a");
}

TEST(SensorTopics, TopicsOfSweepsThatARunCannotUseAreNamed) {
  std::vector<Event> events;
  for (int i = 0; i < 5; ++i) {
    events.push_back(sweep_event(0, 100 * i, "lidar"));
    events.push_back(sweep_event(2, 100 * i, "rear", true));
    events.push_back(sweep_event(3, 100 * i, "side"));
  }
  const auto sweeps = [](const char* name, uint64_t messages) {
    return Topic{name, "sensor_msgs/PointCloud2", TopicKind::sweeps, messages};
  };
  EXPECT_EQ(
      chosen_of({kPoints, sweeps("/front", 0), sweeps("/rear", 5), sweeps("/side", 5)}, events),
      "none; /front is not used: it has no messages; /rear is not used: its first 5 sweeps "
      "are empty");
}

TEST(SensorTopics, AReceiverWithoutAFixIsPassedOver) {
  const auto fix = [](std::size_t topic, GnssFixKind kind) {
    return [topic, kind](int i) {
      const Nanoseconds at = std::chrono::milliseconds(100 * i);
      return Event{.topic = topic,
                   .received = at,
                   .value = GnssFix{.stamp = at, .kind = kind, .latitude = 41.0, .covariance = {}},
                   .bytes = 100,
                   .frame = "gnss"};
    };
  };
  const auto topic = [](const char* name) {
    return Topic{name, "sensor_msgs/NavSatFix", TopicKind::gnss, 100};
  };
  const GivenRecording recording(
      {kPoints, topic("/indoors"), topic("/fix")},
      events_of({fix(1, GnssFixKind::none), fix(2, GnssFixKind::single)}));
  const RecordedSensors sensors = choose_sensors(recording, 0, {});
  EXPECT_EQ(sensors.gnss, 2U);
  ASSERT_EQ(sensors.passed_over.size(), 1U);
  EXPECT_EQ(describe(sensors.passed_over[0]),
            "/indoors is not used: its first 50 messages have no fix");
}

Event velocity_event(std::size_t topic, int ms, const char* frame) {
  const Nanoseconds at = std::chrono::milliseconds(ms);
  return {.topic = topic,
          .received = at,
          .value = BodyVelocity{.stamp = at, .linear = {1.0, 0.0, 0.0}, .frame = frame},
          .bytes = 100,
          .frame = frame};
}

/// Sweeps, wheels, odometry with a twist, poses without one.
GivenRecording with_velocities() {
  std::vector<Event> events =
      events_of({[](int i) { return velocity_event(1, 20 * i, "wheels"); },
                 [](int i) { return velocity_event(2, 20 * i, "base"); },
                 [](int i) { return pose_event(3, 20 * i, "map", "base", 0.1 * i); }});
  events.insert(events.begin(), transform_event(4, 0, "base", "lidar"));
  events.insert(events.begin(), transform_event(4, 0, "base", "wheels"));
  return {{kPoints,
           {"/wheels", "geometry_msgs/TwistWithCovarianceStamped", TopicKind::velocities, 100},
           {"/odom", "nav_msgs/Odometry", TopicKind::poses, 100},
           {"/pose", "geometry_msgs/PoseStamped", TopicKind::poses, 100},
           kStatic,
           {"/radar", "geometry_msgs/TwistStamped", TopicKind::velocities, 0}},
          std::move(events)};
}

TEST(SensorTopics, HeadingsAreUsedOnlyWhereTheirTopicIsNamed) {
  const auto heading = [](int i) {
    const Nanoseconds at = std::chrono::milliseconds(20 * i);
    return Event{.topic = 1,
                 .received = at,
                 .value = Heading{.stamp = at, .yaw = 1.0, .frame = "antenna"},
                 .bytes = 100,
                 .frame = "antenna"};
  };
  const GivenRecording recording(
      {kPoints, {"/heading", "geometry_msgs/QuaternionStamped", TopicKind::headings, 100}},
      events_of({heading}));
  EXPECT_FALSE(choose_sensors(recording, 0, {}).heading);
  Config config;
  config.recording.heading_topic = "/heading";
  EXPECT_EQ(choose_sensors(recording, 0, config).heading, 1U);
  EXPECT_EQ(choose_sensors(recording, 0, config).frames.at(1), "antenna");
  config.gnss.heading = false;
  EXPECT_FALSE(choose_sensors(recording, 0, config).heading);
  config.gnss.heading = true;
  config.recording.heading_topic = "/points";
  try {
    choose_sensors(recording, 0, config);
    FAIL() << "sweeps are no headings";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(),
                 "recording.heading_topic: the recording has no headings on '/points', which has "
                 "sensor_msgs/PointCloud2; it has headings on /heading.");
  }
}

TEST(SensorTopics, VelocitiesAreUsedOnlyWhereTheirTopicIsNamed) {
  const GivenRecording recording = with_velocities();
  EXPECT_FALSE(choose_sensors(recording, 0, {}).velocity);
  Config config;
  config.recording.velocity_topic = "/wheels";
  const RecordedSensors wheels = choose_sensors(recording, 0, config);
  EXPECT_EQ(wheels.velocity, 1U);
  EXPECT_EQ(wheels.frames.at(1), "wheels");
  EXPECT_TRUE(frame_tree_of(wheels.transforms).transform("lidar", "wheels"));
  EXPECT_TRUE(wheels.passed_over.empty());
  config.recording.velocity_topic = "/odom";
  const RecordedSensors odometry = choose_sensors(recording, 0, config);
  EXPECT_EQ(odometry.velocity, 2U);
  EXPECT_EQ(odometry.frames.at(2), "base");
  config.velocity.use = false;
  EXPECT_FALSE(choose_sensors(recording, 0, config).velocity);
}

TEST(SensorTopics, AVelocityTopicWithoutMessagesIsSaid) {
  Config config;
  config.recording.velocity_topic = "/radar";
  const RecordedSensors sensors = choose_sensors(with_velocities(), 0, config);
  EXPECT_FALSE(sensors.velocity);
  ASSERT_EQ(sensors.passed_over.size(), 1U);
  EXPECT_EQ(describe(sensors.passed_over[0]), "/radar is not used: it has no messages");
}

TEST(SensorTopics, FurtherRangeSensorsAreMountedByTransformsOrSettings) {
  const Topic rear{"/rear", "sensor_msgs/PointCloud2", TopicKind::sweeps, 1};
  std::vector<Event> events{transform_event(2, 0, "lidar", "rear", 0.5), sweep_event(0, 0, "lidar"),
                            sweep_event(1, 0, "rear")};
  const GivenRecording recording({kPoints, rear, kStatic}, events);
  Config config;
  EXPECT_EQ(choose_sensors(recording, 0, config).sweeps.size(), 1U);
  config.recording.further_sweep_topics = {"/rear"};
  const RecordedSensors by_transform = choose_sensors(recording, 0, config);
  ASSERT_EQ(by_transform.sweeps.size(), 2U);
  EXPECT_EQ(by_transform.sweeps[0].frame, "lidar");
  EXPECT_EQ(by_transform.sweeps[1].topic, 1U);
  EXPECT_EQ(by_transform.sweeps[1].frame, "rear");
  EXPECT_EQ(by_transform.sweeps[1].sensor.c_max, config.preprocess.c_max);
  EXPECT_NEAR(so3_log(by_transform.sweeps[1].sensor.T_lidar_sensor.linear()).z(), 0.5, 1e-9);
  config.recording.T_lidar_further = {{1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}};
  const RecordedSensors by_setting = choose_sensors(recording, 0, config);
  EXPECT_EQ(by_setting.sweeps[1].sensor.T_lidar_sensor.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(SensorTopics, AFurtherRangeSensorWithoutMountingOrTopicIsAnError) {
  const Topic rear{"/rear", "sensor_msgs/PointCloud2", TopicKind::sweeps, 1};
  const GivenRecording recording({kPoints, rear, imu("/imu")},
                                 {sweep_event(0, 0, "lidar"), sweep_event(1, 0, "rear")});
  const auto error_of = [&](const std::vector<std::string>& names) -> std::string {
    Config config;
    config.recording.further_sweep_topics = names;
    try {
      choose_sensors(recording, 0, config);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(error_of({"/rear"}),
            "recording.further_sweep_topics: no transform connects 'rear', the frame of /rear, "
            "with 'lidar'. Give the pose of the sensor in the first one's axes: --set "
            "'recording.T_lidar_further=[[x, y, z, qx, qy, qz, qw]]'.");
  EXPECT_EQ(error_of({"/imu"}),
            "recording.further_sweep_topics: the recording has no sweeps on '/imu'; adit inspect "
            "lists its topics.");
  EXPECT_EQ(error_of({"/points"}), "recording.further_sweep_topics: '/points' is named twice.");
}

TEST(SensorTopics, AWrongVelocityTopicIsAnErrorThatNamesThoseThatThereAre) {
  const auto error_of = [](const Recording& recording, const char* name) -> std::string {
    Config config;
    config.recording.velocity_topic = name;
    try {
      choose_sensors(recording, 0, config);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "none";
  };
  const GivenRecording recording = with_velocities();
  EXPECT_EQ(error_of(recording, "/wheel"),
            "recording.velocity_topic: the recording has no velocities on '/wheel'; it has "
            "velocities on /wheels, /odom, /pose, /radar.");
  EXPECT_EQ(error_of(recording, "/points"),
            "recording.velocity_topic: the recording has no velocities on '/points', which has "
            "sensor_msgs/PointCloud2; it has velocities on /wheels, /odom, /pose, /radar.");
  EXPECT_EQ(error_of(GivenRecording({kPoints}, {sweep_event(0, 0, "lidar")}), "/wheels"),
            "recording.velocity_topic: the recording has no velocities on '/wheels'; it has none.");
}

TEST(RecordedTransforms, AStaticTransformThatComesLateIsReadWhereItIsNeeded) {
  std::vector<Event> events{transform_event(1, 0, "base", "imu")};
  for (int s = 0; s < 60; ++s) {
    events.push_back(sweep_event(0, 1000 * s, "lidar"));
  }
  events.push_back(transform_event(1, 60000, "base", "lidar"));
  const GivenRecording recording({kPoints, kStatic}, events);
  EXPECT_EQ(recorded_transforms(recording, {"lidar", "imu"}).transforms.size(), 2U);
  EXPECT_EQ(recorded_transforms(recording, {"imu", "base"}).transforms.size(), 1U)
      << "the rest of the recording is not read in vain";
}

TEST(RecordedTransforms, ConstantTransformsOfMovingFramesConnectWhereStaticOnesDoNot) {
  std::vector<Event> events{transform_event(1, 0, "base", "imu")};
  for (int i = 0; i < 100; ++i) {
    events.push_back(pose_event(2, 50 * i, "base", "lidar", 0.25));
    events.push_back(pose_event(2, 50 * i, "base", "camera", 0.5));
    events.push_back(pose_event(2, 50 * i, "odom", "base", 0.1 * i));
  }
  const GivenRecording recording({kPoints, kStatic, kMoving}, events);
  const RecordedTransforms found = recorded_transforms(recording, {"lidar", "imu"});
  EXPECT_EQ(names_of(found.constant), "'base' to 'lidar'") << "what nothing needs is left alone";
  const auto T = frame_tree_of(found).transform("imu", "lidar");
  ASSERT_TRUE(T);
  EXPECT_DOUBLE_EQ(T->translation().x(), 0.25);
  ASSERT_EQ(notes_of(found).size(), 1U);
  EXPECT_NE(notes_of(found)[0].find("stay constant on /tf"), std::string::npos);
}

TEST(RecordedTransforms, AMovingOrBarelySeenTransformIsNoMounting) {
  std::vector<Event> moving;
  for (int i = 0; i < 100; ++i) {
    moving.push_back(pose_event(1, 50 * i, "imu", "lidar", 1e-3 * i));
  }
  EXPECT_TRUE(recorded_transforms(GivenRecording({kPoints, kMoving}, moving), {"lidar", "imu"})
                  .constant.empty());
  const std::vector<Event> few = {pose_event(1, 0, "imu", "lidar", 0.0),
                                  pose_event(1, 2000, "imu", "lidar", 0.0)};
  EXPECT_TRUE(recorded_transforms(GivenRecording({kPoints, kMoving}, few), {"lidar", "imu"})
                  .constant.empty());
}

TEST(RecordedTransforms, WhatIsIgnoredOrNormalisedIsSaid) {
  Event scaled = transform_event(1, 0, "imu", "lidar");
  std::get<StaticTransform>(scaled.value).quaternion_length = 2.0;
  const GivenRecording recording({kPoints, kStatic},
                                 {scaled, transform_event(1, 0, "lidar", "lidar"),
                                  transform_event(1, 0, "lidar", "imu", 3.0)});
  const std::vector<std::string> notes = notes_of(recorded_transforms(recording, {"lidar", "imu"}));
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_EQ(notes[0],
            "the transform from 'lidar' to 'lidar' leads from a frame to itself; it is ignored");
  EXPECT_EQ(notes[1],
            "the transform from 'lidar' to 'imu' closes a loop of frames and contradicts it; it is "
            "ignored");
  EXPECT_EQ(notes[2],
            "static transforms have quaternions that are not of length 1: 'imu' to 'lidar'; they "
            "are normalised");
}

}  // namespace
}  // namespace adit
