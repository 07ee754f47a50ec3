// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Velocities in messages: of wheels, radars and the twist of another odometry.
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/recordings/one_sensor.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/topic_survey.hpp"
#include "adit/tools/recordings/velocities_of_poses.hpp"

namespace adit {
namespace {

using test::TemporaryFolder;

constexpr std::array kEncodings = {Encoding::ros1, Encoding::cdr};

template <class Message>
Channel channel_of(const std::string& topic, const Message&, Encoding encoding) {
  return {.topic = topic,
          .type = std::string(Message::kType),
          .encoding = encoding,
          .definition = {},
          .messages = std::nullopt};
}

/// The velocity in a message, by its own topic's kind.
template <class Message>
BodyVelocity velocity_in(const Message& message, Encoding encoding) {
  const Channel channel = channel_of("/wheels", message, encoding);
  EXPECT_EQ(ros::kind_of(channel), TopicKind::velocities);
  const std::vector<std::byte> bytes = ros::encode(encoding, message);
  const ros::MessageEvents events = ros::to_events(channel, {0, Nanoseconds(9), bytes, 0}, "drive");
  EXPECT_EQ(events.values.size(), 1U);
  EXPECT_EQ(events.frame, message.header.frame);
  return std::get<BodyVelocity>(events.values.at(0));
}

TEST(Velocities, BothMessagesAreReadInBothEncodings) {
  for (const Encoding encoding : kEncodings) {
    const BodyVelocity radar = velocity_in(test::twist_message(2), encoding);
    EXPECT_EQ(radar.stamp, test::header(2, "").stamp);
    EXPECT_EQ(radar.linear, Eigen::Vector3d(1.5, -0.25, 0.25));
    EXPECT_EQ(radar.frame, "radar");
    EXPECT_FALSE(radar.covariance);
    const BodyVelocity wheels = velocity_in(test::twist_with_covariance_message(4), encoding);
    EXPECT_EQ(wheels.linear, Eigen::Vector3d(2.0, 0.0, 0.25));
    EXPECT_EQ(wheels.frame, "wheels");
    ASSERT_TRUE(wheels.covariance);
    Eigen::Matrix3d expected = Eigen::Matrix3d::Constant(0.001);
    expected.diagonal() << 0.01, 0.08, 0.15;
    EXPECT_TRUE(wheels.covariance->isApprox(expected)) << *wheels.covariance;
  }
}

TEST(Velocities, AMessageWithoutATimeCountsAsTakenWhenItWasReceived) {
  ros::TwistStamped message = test::twist_message(1);
  message.header.stamp = Nanoseconds(0);
  EXPECT_EQ(velocity_in(message, Encoding::cdr).stamp, Nanoseconds(9));
}

TEST(Velocities, ACovarianceThatCannotBeOneIsNone) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto with = [](std::size_t at, double value) {
    ros::TwistWithCovarianceStamped message = test::twist_with_covariance_message(1);
    message.covariance[at] = value;
    return velocity_in(message, Encoding::cdr).covariance;
  };
  EXPECT_FALSE(with(0, -1.0));
  EXPECT_FALSE(with(7, -1e-9));
  EXPECT_FALSE(with(14, kNan));
  EXPECT_FALSE(with(1, kInfinity));
  EXPECT_TRUE(with(21, kNan)) << "of the angular velocity, which is not read";
  EXPECT_TRUE(with(0, 1e-4));
  ros::TwistWithCovarianceStamped zeros = test::twist_with_covariance_message(1);
  zeros.covariance.fill(0.0);
  EXPECT_FALSE(velocity_in(zeros, Encoding::cdr).covariance);
}

TEST(Velocities, AreWrittenAsTheyAreRead) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Constant(0.002);
  covariance.diagonal() << 0.01, 0.02, 0.03;
  const BodyVelocity known{.stamp = Nanoseconds(1700000000123456789),
                           .linear = {1.0, -2.0, 0.5},
                           .covariance = covariance,
                           .frame = "wheels"};
  BodyVelocity partly{.stamp = Nanoseconds(1700000000000000007), .linear = {3.0, 0.0, 0.0}};
  partly.linear.z() = std::numeric_limits<double>::quiet_NaN();
  for (const Encoding encoding : kEncodings) {
    for (const BodyVelocity& velocity : {known, partly}) {
      const ros::EncodedEvent encoded = ros::from_event(velocity, encoding, "base");
      EXPECT_EQ(encoded.type, "geometry_msgs/TwistWithCovarianceStamped");
      const auto message = ros::decode<ros::TwistWithCovarianceStamped>(encoding, encoded.bytes);
      const BodyVelocity again = velocity_in(message, encoding);
      EXPECT_EQ(again.stamp, velocity.stamp);
      EXPECT_EQ(again.linear.head<2>(), velocity.linear.head<2>());
      EXPECT_EQ(std::isnan(again.linear.z()), std::isnan(velocity.linear.z()));
      EXPECT_EQ(again.covariance, velocity.covariance);
      EXPECT_EQ(again.frame, velocity.frame.empty() ? "base" : velocity.frame);
    }
  }
}

TEST(Velocities, ACutOffMessageIsReported) {
  for (const Encoding encoding : kEncodings) {
    const auto message = test::twist_with_covariance_message(1);
    const std::vector<std::byte> bytes = ros::encode(encoding, message);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_THROW(ros::to_events(channel_of("/wheels", message, encoding),
                                  {0, Nanoseconds(1), std::span(bytes).first(size), 0}, "drive"),
                   ros::CodecError)
          << size;
    }
  }
}

/// Wheels, odometry and commands without a stamp.
void write_drive(MessageWriter& writer, Encoding encoding) {
  std::vector<std::size_t> ids;
  for (const auto& [topic, type] :
       {std::pair{"/wheels", "geometry_msgs/TwistWithCovarianceStamped"},
        {"/radar", "geometry_msgs/TwistStamped"},
        {"/odom", "nav_msgs/Odometry"},
        {"/cmd_vel", "geometry_msgs/Twist"}}) {
    ids.push_back(writer.add_channel({.topic = topic,
                                      .type = type,
                                      .encoding = encoding,
                                      .definition = {},
                                      .messages = std::nullopt}));
  }
  for (uint32_t i = 0; i < 5; ++i) {
    const Nanoseconds at = test::header(i, "").stamp;
    writer.write(ids[0], at, ros::encode(encoding, test::twist_with_covariance_message(i)));
    writer.write(ids[1], at, ros::encode(encoding, test::twist_message(i)));
    writer.write(ids[2], at, ros::encode(encoding, test::odometry_message(i)));
    writer.write(ids[3], at, std::vector<std::byte>(48));
  }
  writer.close();
}

TEST(Velocities, AreTopicsOfRecordings) {
  const TemporaryFolder folder;
  McapWriter mcap(folder / "drive.mcap", {});
  write_drive(mcap, Encoding::cdr);
  BagWriter bag(folder / "drive.bag", {});
  write_drive(bag, Encoding::ros1);
  for (const char* file : {"drive.mcap", "drive.bag"}) {
    const auto recording = open_recording(folder / file);
    const std::vector<Topic>& topics = recording->topics();
    ASSERT_EQ(topics.size(), 4U);
    EXPECT_EQ(to_string(topics[0].kind), "velocities");
    EXPECT_EQ(topics[1].kind, TopicKind::velocities);
    EXPECT_EQ(topics[2].kind, TopicKind::poses);
    EXPECT_EQ(topics[3].kind, TopicKind::other) << "it has no stamp";
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(read.errors.empty());
    ASSERT_EQ(read.events.size(), 15U);
    EXPECT_TRUE(std::holds_alternative<BodyVelocity>(read.events[0].value));
    EXPECT_TRUE(std::holds_alternative<BodyVelocity>(read.events[1].value));
    EXPECT_TRUE(std::holds_alternative<ReferencePose>(read.events[2].value));
    EXPECT_EQ(stamp_of(read.events[3]), test::header(1, "").stamp);
  }
}

TEST(Velocities, OfAnOdometryTopicAreItsTwistWhereTheSelectionNamesIt) {
  const TemporaryFolder folder;
  McapWriter mcap(folder / "drive.mcap", {});
  write_drive(mcap, Encoding::cdr);
  const auto recording = open_recording(folder / "drive.mcap");
  const test::ReadEvents read = test::read_all(*recording, {.topics = {2}, .velocities_of = 2});
  ASSERT_EQ(read.events.size(), 5U);
  for (const Event& event : read.events) {
    const auto& velocity = std::get<BodyVelocity>(event.value);
    EXPECT_EQ(velocity.linear, Eigen::Vector3d(5.0, 0.0, 0.0));
    EXPECT_EQ(velocity.frame, "base_link");
    EXPECT_EQ(event.frame, "base_link");
    EXPECT_FALSE(velocity.covariance);
  }
  // That of another topic changes nothing.
  const test::ReadEvents wheels = test::read_all(*recording, {.topics = {2}, .velocities_of = 0});
  EXPECT_TRUE(std::holds_alternative<ReferencePose>(wheels.events.at(0).value));
}

TEST(Velocities, TheSurveyKnowsFrameRateAndFault) {
  const TemporaryFolder folder;
  McapWriter mcap(folder / "drive.mcap", {});
  write_drive(mcap, Encoding::cdr);
  const auto recording = open_recording(folder / "drive.mcap");
  for (const auto& [topic, frame] :
       {std::tuple{0U, "wheels"}, std::tuple{1U, "radar"}, std::tuple{2U, "base_link"}}) {
    const std::vector<SensorSample> samples = first_samples(*recording, topic);
    ASSERT_EQ(samples.size(), 1U);
    EXPECT_EQ(samples[0].frame, frame);
    EXPECT_NEAR(samples[0].rate, 10.0, 1e-6);
    EXPECT_EQ(samples[0].fault, "");
  }
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Event> events;
  for (int i = 0; i < 3; ++i) {
    const Nanoseconds at = std::chrono::milliseconds(20 * i);
    events.push_back({.topic = 0,
                      .received = at,
                      .value = BodyVelocity{.stamp = at, .linear = {kNan, kNan, kNan}}});
  }
  const test::GivenRecording broken({{"/wheels", "", TopicKind::velocities, 3}}, events);
  EXPECT_EQ(fault_of_topic(broken, 0), "its first 3 velocities have no numbers");
}

TEST(Velocities, OfTwoSensorsOnOneTopicThoseOfOneFrameAreUsed) {
  std::vector<Event> events;
  for (int i = 0; i < 6; ++i) {
    const Nanoseconds at = std::chrono::milliseconds(20 * i);
    events.push_back({.topic = 0,
                      .received = at,
                      .value = BodyVelocity{.stamp = at, .linear = {1.0, 0.0, 0.0}},
                      .frame = i % 2 == 0 ? "left" : "right"});
  }
  const test::GivenRecording recording({{"/wheels", "", TopicKind::velocities, 6}}, events);
  const OneSensorRecording one(recording, {{0, "right"}});
  EXPECT_EQ(test::read_all(one).events.size(), 3U);
}

/// On a circle at 2 m/s, turning by 1 rad/s, seen from another frame: x ahead.
ReferencePose on_circle(Nanoseconds stamp) {
  const double angle = seconds(stamp);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = 2.0 * Eigen::Vector3d(std::sin(angle), 1.0 - std::cos(angle), 0.0);
  T.linear() = so3_exp({0.0, 0.0, angle});
  const Eigen::Isometry3d T_map_start(Eigen::Translation3d(5.0, 6.0, 7.0) *
                                      Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()));
  return {.stamp = stamp, .parent = "vo", .child = "camera", .T_parent_child = T_map_start * T};
}

TEST(Velocities, PosesOfAnotherOdometryGiveVelocitiesInTheirOwnAxes) {
  const ReferencePose from = on_circle(std::chrono::milliseconds(700));
  const auto velocity = velocity_between(from, on_circle(std::chrono::milliseconds(750)));
  ASSERT_TRUE(velocity);
  EXPECT_EQ(velocity->stamp, std::chrono::milliseconds(725));
  EXPECT_EQ(velocity->frame, "camera");
  EXPECT_FALSE(velocity->covariance);
  EXPECT_LT((velocity->linear - Eigen::Vector3d(2.0, 0.0, 0.0)).norm(), 1e-3);
  EXPECT_FALSE(velocity_between(from, from)) << "the same moment";
  EXPECT_FALSE(velocity_between(from, on_circle(std::chrono::milliseconds(600)))) << "backwards";
  EXPECT_FALSE(velocity_between(from, on_circle(std::chrono::milliseconds(1800)))) << "a gap";
}

TEST(Velocities, OfATopicOfPosesTheOtherEventsStayAsTheyAre) {
  std::vector<Event> events;
  for (int i = 0; i < 5; ++i) {
    const Nanoseconds at = std::chrono::milliseconds(50 * i);
    events.push_back({.topic = 0, .received = at, .value = on_circle(at)});
    events.push_back({.topic = 1, .received = at, .value = on_circle(at)});
  }
  const test::GivenRecording recording(
      {{"/vo", "nav_msgs/Odometry", TopicKind::poses, 5}, {"/truth", "", TopicKind::poses, 5}},
      events);
  const auto stream = with_velocities_of_poses(recording.events({}), 0);
  std::size_t velocities = 0;
  std::size_t poses = 0;
  while (const auto event = stream->next()) {
    velocities += std::holds_alternative<BodyVelocity>(event->value) ? 1U : 0U;
    poses += std::holds_alternative<ReferencePose>(event->value) ? 1U : 0U;
    EXPECT_EQ(std::holds_alternative<BodyVelocity>(event->value), event->topic == 0);
  }
  EXPECT_EQ(velocities, 4U) << "one from each pose to the next";
  EXPECT_EQ(poses, 5U);
}

}  // namespace
}  // namespace adit
