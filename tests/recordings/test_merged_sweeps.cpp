// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/merged_sweeps.hpp"

#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"

namespace adit {
namespace {

using test::GivenRecording;
using test::read_all;
using test::reading_event;
using test::sweep_event;

constexpr int kSweeps = 20;

/// Two range sensors, of which the second is 30 ms behind, and an inertial one.
GivenRecording two_lidars() {
  std::vector<Event> events;
  for (int i = 0; i < kSweeps; ++i) {
    events.push_back(sweep_event(0, 100 * i, "front"));
    events.push_back(reading_event(2, 100 * i + 10, "imu"));
    events.push_back(sweep_event(1, 100 * i + 30, "rear"));
  }
  return {{{"/front", "sensor_msgs/PointCloud2", TopicKind::sweeps, kSweeps},
           {"/rear", "sensor_msgs/PointCloud2", TopicKind::sweeps, kSweeps},
           {"/imu", "sensor_msgs/Imu", TopicKind::imu, kSweeps}},
          events};
}

std::vector<MergedTopic> both() {
  std::vector<MergedTopic> topics{{.topic = 0, .frame = "front"}, {.topic = 1, .frame = "rear"}};
  topics[1].sensor.T_lidar_sensor.translate(Eigen::Vector3d(-2.0, 0.0, 0.0));
  return topics;
}

TEST(MergedRecording, SweepsOfBothAreOneSeriesOfTheFirstTopic) {
  const GivenRecording recording = two_lidars();
  const MergedRecording merged(recording, both(), "drive");
  EXPECT_FALSE(merged.topics()[0].messages) << "how many come is not known";
  std::size_t number = 0;
  std::size_t readings = 0;
  for (const Event& event : read_all(merged, {.topics = {0, 2}}).events) {
    if (const auto* sweep = std::get_if<Sweep>(&event.value)) {
      EXPECT_EQ(event.topic, 0U);
      EXPECT_EQ(event.frame, "front");
      EXPECT_EQ(event.number, number++);
      ASSERT_EQ(sweep->points.size(), 2U);
      EXPECT_EQ(sweep->points[1].x, sweep->points[0].x - 2.0F);
      EXPECT_NEAR(sweep->times[1], 0.03, 1e-6);
    } else {
      ++readings;
    }
  }
  EXPECT_EQ(number, std::size_t{kSweeps});
  EXPECT_EQ(readings, std::size_t{kSweeps});
  ASSERT_EQ(merged.notes().size(), 2U);
  EXPECT_EQ(merged.notes()[1], "/rear: 20 sweeps, 20 points in 20 merged sweeps");
}

TEST(MergedRecording, WithoutATopicAllAreRead) {
  const GivenRecording recording = two_lidars();
  const MergedRecording merged(recording, both(), "drive");
  EXPECT_EQ(read_all(merged, {}).events.size(), std::size_t{2 * kSweeps});
}

TEST(MergedRecording, SweepsThatAreSkippedAreMergedOnes) {
  const GivenRecording recording = two_lidars();
  const MergedRecording merged(recording, both(), "drive");
  const auto event = merged.events({.topics = {0}, .skip = 7})->next();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->number, 7U);
  EXPECT_EQ(stamp_of(*event), std::chrono::milliseconds(700));
}

TEST(MergedRecording, WithOneTopicOrForOthersNothingChanges) {
  const GivenRecording recording = two_lidars();
  const MergedRecording one(recording, {{.topic = 1, .frame = "rear"}}, "drive");
  EXPECT_EQ(one.topics()[1].messages, std::size_t{kSweeps});
  EXPECT_EQ(read_all(one, {.topics = {1}}).events.size(), std::size_t{kSweeps});
  EXPECT_TRUE(one.notes().empty());
  const MergedRecording merged(recording, both(), "drive");
  EXPECT_EQ(read_all(merged, {.topics = {2}}).events.size(), std::size_t{kSweeps});
}

}  // namespace
}  // namespace adit
