// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/topic_survey.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tools/recordings/one_sensor.hpp"

namespace adit {
namespace {

using test::GivenRecording;
using test::reading_event;
using test::sweep_event;

Topic sweeps(const char* name, std::optional<uint64_t> messages) {
  return {name, "sensor_msgs/PointCloud2", TopicKind::sweeps, messages};
}

TEST(TopicSurvey, OfTopicsOfSweepsTheOneWithMessagesIsChosen) {
  const GivenRecording silent({sweeps("/front", 0), sweeps("/rear", 1)},
                              {sweep_event(1, 0, "rear")});
  EXPECT_EQ(sweep_topic(silent, "drive", {}), 1U);
  EXPECT_EQ(sweep_topic(silent, "drive", "/front"), 0U) << "who names it wants it";
}

TEST(TopicSurvey, WhereNoTopicHasMessagesTheOnlyOneIsLeft) {
  EXPECT_EQ(sweep_topic(GivenRecording({sweeps("/front", 0)}, {}), "drive", {}), 0U);
  EXPECT_THROW(
      sweep_topic(GivenRecording({sweeps("/front", 0), sweeps("/rear", 0)}, {}), "drive", {}),
      InputError);
}

TEST(TopicSurvey, WhereCountsAreUnknownTheMessagesAreLookedAt) {
  const GivenRecording unknown({sweeps("/front", {}), sweeps("/rear", {})},
                               {sweep_event(1, 0, "rear")});
  EXPECT_EQ(sweep_topic(unknown, "drive", {}), 1U);
  EXPECT_EQ(fault_of_topic(unknown, 0), "not one of its messages can be read");
}

TEST(TopicSurvey, ATopicOfEmptyCloudsIsPassedOver) {
  std::vector<Event> events;
  for (int i = 0; i < 20; ++i) {
    events.push_back(sweep_event(0, 100 * i, "front", true));
    events.push_back(sweep_event(1, 100 * i, "rear"));
  }
  const GivenRecording empty({sweeps("/front", 20), sweeps("/rear", 20)}, events);
  EXPECT_EQ(sweep_topic(empty, "drive", {}), 1U);
  EXPECT_EQ(fault_of_topic(empty, 0), "its first 10 sweeps are empty");
}

TEST(TopicSurvey, TwoTopicsWithSweepsAskForAChoiceAndASilentOneIsNotAmongThem) {
  const GivenRecording two({sweeps("/a", 0), sweeps("/b", 1), sweeps("/c", 1)},
                           {sweep_event(1, 0, "b"), sweep_event(2, 0, "c")});
  try {
    sweep_topic(two, "drive", {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.found(), "it has 2 topics of sweeps: /b, /c");
  }
}

TEST(TopicSurvey, FramesOfATopicAreTheSensorsOnIt) {
  std::vector<Event> events;
  for (int i = 0; i < 30; ++i) {
    events.push_back(reading_event(0, 10 * i, i % 3 == 0 ? "/imu_b" : "imu_a"));
    events.push_back(reading_event(0, 10 * i + 1, ""));
  }
  const GivenRecording recording({{"/imu", "sensor_msgs/Imu", TopicKind::imu, 60}}, events);
  const std::vector<SensorSample> samples = first_samples(recording, 0);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].frame, "imu_a");
  EXPECT_EQ(samples[0].events, 50U) << "those without a frame are of the frame with most";
  EXPECT_EQ(samples[1].frame, "imu_b");
  EXPECT_NEAR(samples[1].rate, 1.0 / 0.03, 1e-6);
  EXPECT_EQ(samples[0].fault, "");
}

TEST(TopicSurvey, WhyAnImuOrAReceiverCannotBeUsed) {
  const auto fault = [](TopicKind kind, const std::vector<EventValue>& values) {
    std::vector<Event> events;
    for (const EventValue& value : values) {
      events.push_back({.topic = 0, .received = Nanoseconds(0), .value = value, .bytes = 1});
    }
    const GivenRecording recording({{"/x", "", kind, values.size()}}, events);
    return first_samples(recording, 0).at(0).fault;
  };
  const Eigen::Vector3d some(0.0, 0.1, 9.8);
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::nan(""));
  EXPECT_EQ(fault(TopicKind::imu, {ImuSample{Nanoseconds(1), none, none}}),
            "its first 1 readings are all zero");
  EXPECT_EQ(fault(TopicKind::imu, {ImuSample{Nanoseconds(1), nan, some}}),
            "it has no angular velocities");
  EXPECT_EQ(fault(TopicKind::imu, {ImuSample{Nanoseconds(1), none, some}}),
            "its first 1 angular velocities are all zero");
  EXPECT_EQ(fault(TopicKind::imu, {ImuSample{Nanoseconds(1), some, none}}),
            "its first 1 accelerations are all zero");
  EXPECT_EQ(fault(TopicKind::imu,
                  {ImuSample{Nanoseconds(1), some, some}, ImuSample{Nanoseconds(1), some, some}}),
            "its clock stands still");
  EXPECT_EQ(fault(TopicKind::gnss, {GnssFix{.stamp = Nanoseconds(1), .covariance = {}}}),
            "its first 1 messages have no fix");
  EXPECT_EQ(fault(TopicKind::gnss, {GnssFix{.stamp = Nanoseconds(1),
                                            .kind = GnssFixKind::single,
                                            .latitude = std::nan(""),
                                            .covariance = {}}}),
            "its first 1 messages have no fix");
}

/// Frames of the sweeps that a stream gives.
std::vector<std::string> frames_of(const Recording& recording) {
  std::vector<std::string> frames;
  for (const Event& event : test::read_all(recording).events) {
    frames.push_back(event.frame);
  }
  return frames;
}

TEST(OneSensor, OfTwoThatTakeTurnsOneIsUsedAndTheOtherCounted) {
  std::vector<Event> events;
  for (int i = 0; i < 10; ++i) {
    events.push_back(sweep_event(0, 100 * i, "front"));
    events.push_back(sweep_event(0, 100 * i + 50, "rear"));
  }
  const GivenRecording both({sweeps("/points", 20)}, events);
  const OneSensorRecording one(both, {{0, "rear"}});
  EXPECT_EQ(frames_of(one), std::vector<std::string>(10, "rear"));
  ASSERT_EQ(one.notes().size(), 1U);
  EXPECT_EQ(one.notes()[0],
            "10 messages of /points from the frame 'front' are left out: they are another "
            "sensor's; 'rear' is used");
  const OneSensorRecording first(both, {});
  EXPECT_EQ(frames_of(first), std::vector<std::string>(10, "front"));
}

TEST(OneSensor, ASecondThatStartsLaterIsLeftOutToo) {
  std::vector<Event> events;
  for (int i = 0; i < 40; ++i) {
    events.push_back(sweep_event(0, 100 * i, "front"));
    if (i > 20) {
      events.push_back(sweep_event(0, 100 * i + 50, "rear"));
    }
  }
  events.push_back(sweep_event(0, 9000, "rear"));  // the first has ended: still another one
  const GivenRecording both({sweeps("/points", 60)}, events);
  EXPECT_EQ(frames_of(OneSensorRecording(both, {{0, "front"}})),
            std::vector<std::string>(40, "front"));
}

TEST(OneSensor, ASensorThatIsRenamedIsTheSame) {
  std::vector<Event> events;
  for (int i = 0; i < 40; ++i) {
    events.push_back(sweep_event(0, 100 * i + (i < 10 ? 0 : 2000), i < 10 ? "/old" : "new"));
    events.push_back(reading_event(1, 100 * i, ""));
  }
  const GivenRecording renamed(
      {sweeps("/points", 40), {"/imu", "sensor_msgs/Imu", TopicKind::imu, 40}}, events);
  const OneSensorRecording one(renamed, {{0, "old"}});
  EXPECT_EQ(frames_of(one).size(), 80U);
  ASSERT_EQ(one.notes().size(), 1U);
  EXPECT_EQ(one.notes()[0],
            "the frame of /points changes from 'old' to 'new'; it is taken for the same sensor");
  // A part of the recording after the renaming.
  const auto part = one.events({.begin = std::chrono::milliseconds(3000)});
  std::size_t given = 0;
  while (const auto event = part->next()) {
    given += event->topic == 0 ? 1U : 0U;
  }
  EXPECT_EQ(given, 19U) << "those of the first second might be another sensor's";
}

}  // namespace
}  // namespace adit
