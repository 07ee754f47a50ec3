// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/sweep_feed.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/run/imu_mounting.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

/// Events in memory, in the order in which they were recorded: sweeps on topic 0, an IMU on topic
/// 1, transforms on topic 2.
class EventList : public Recording {
 public:
  explicit EventList(std::vector<Event> events, std::size_t damage = 1'000'000)
      : events_(std::move(events)), damage_(damage) {}

  const std::vector<Topic>& topics() const override { return topics_; }
  std::string description() const override { return "made for a test"; }
  bool times_are_assumed() const override { return false; }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<Stream>(*this, selection);
  }

 private:
  class Stream : public EventStream {
   public:
    Stream(const EventList& list, const EventSelection& selection)
        : list_(&list), selection_(selection) {}
    std::optional<Event> next() override {
      for (; at_ < list_->events_.size(); ++at_) {
        if (at_ == list_->damage_ && !std::exchange(told_, true)) {
          throw InputError("list", Place(), "is damaged", "Record it again");
        }
        const Event& event = list_->events_[at_];
        if (std::ranges::find(selection_.topics, event.topic) == selection_.topics.end() ||
            selection_.skip > skipped_++) {
          continue;
        }
        ++at_;
        return event;
      }
      return std::nullopt;
    }

   private:
    const EventList* list_;
    EventSelection selection_;
    std::size_t at_ = 0;
    std::size_t skipped_ = 0;
    bool told_ = false;
  };

  std::vector<Event> events_;
  std::size_t damage_;
  std::vector<Topic> topics_ = {{"/points", "made", TopicKind::sweeps, std::nullopt},
                                {"/imu", "made", TopicKind::imu, std::nullopt},
                                {"/tf_static", "made", TopicKind::transforms, std::nullopt}};
};

Event sweep(int begin_ms, int received_ms) {
  Sweep value;
  value.stamp = milliseconds(begin_ms);
  value.points = {{1.0F, 2.0F, 3.0F, 0.0F}, {1.0F, 2.0F, 3.0F, 0.0F}};
  value.times = {0.0F, 0.09375F};
  return {.topic = 0, .received = milliseconds(received_ms), .value = value, .frame = "lidar"};
}

Event reading(int time_ms) {
  ImuSample value;
  value.stamp = milliseconds(time_ms);
  return {.topic = 1, .received = milliseconds(time_ms), .value = value, .frame = "imu"};
}

/// Readings every 10 ms of the times that `there` keeps; sweeps of 100 ms that arrive at their end.
std::vector<Event> drive(int sweeps, const std::function<bool(int)>& there) {
  std::vector<Event> events;
  for (int time = 0; time <= 100 * sweeps + 50; time += 10) {
    if (time > 0 && time % 100 == 0 && time <= 100 * sweeps) {
      events.push_back(sweep(time - 100, time));
    }
    if (there(time)) {
      events.push_back(reading(time));
    }
  }
  return events;
}

/// What came out: each sweep's begin with the newest reading before it, ms.
std::vector<std::pair<long, long>> fed(const Recording& recording, const SweepFeedTopics& topics) {
  std::vector<std::pair<long, long>> result;
  long newest = -1;
  const auto ms = [](Nanoseconds stamp) {
    return static_cast<long>(std::chrono::duration_cast<milliseconds>(stamp).count());
  };
  SweepFeed feed(recording, topics, [&](const ImuSample& sample) { newest = ms(sample.stamp); });
  while (const auto event = feed.next()) {
    result.emplace_back(ms(std::get<Sweep>(event->value).stamp), newest);
  }
  return result;
}

using Fed = std::vector<std::pair<long, long>>;

TEST(SweepFeed, ASweepComesOnceTheReadingsCoverIt) {
  const EventList list(drive(4, [](int) { return true; }));
  EXPECT_EQ(fed(list, {.sweeps = 0, .imu = 1}),
            (Fed{{0, 100}, {100, 200}, {200, 300}, {300, 400}}));
}

TEST(SweepFeed, WithoutAnImuSweepsComeAsTheyAreRead) {
  const EventList list(drive(3, [](int) { return true; }));
  EXPECT_EQ(fed(list, {.sweeps = 0}), (Fed{{0, -1}, {100, -1}, {200, -1}}));
  EXPECT_EQ(fed(list, {.sweeps = 0, .imu = {}, .first = 2}), (Fed{{200, -1}}));
}

TEST(SweepFeed, SweepsBeforeTheFirstArePassedOverAndReadingsAreNot) {
  const EventList list(drive(4, [](int) { return true; }));
  EXPECT_EQ(fed(list, {.sweeps = 0, .imu = 1, .first = 2}), (Fed{{200, 300}, {300, 400}}));
}

TEST(SweepFeed, AnImuThatStopsHoldsNoSweepForLong) {
  const EventList list(drive(12, [](int time) { return time <= 250; }));
  const Fed result = fed(list, {.sweeps = 0, .imu = 1});
  ASSERT_EQ(result.size(), 12U);
  EXPECT_EQ(result[1], (std::pair<long, long>{100, 200}));
  for (std::size_t i = 2; i < result.size(); ++i) {
    EXPECT_EQ(result[i], (std::pair<long, long>{100 * static_cast<long>(i), 250}));
  }
}

TEST(SweepFeed, DamageIsThrownAndNoSweepAroundItLost) {
  const EventList list(drive(4, [](int) { return true; }), 22);
  SweepFeed feed(list, {.sweeps = 0, .imu = 1}, [](const ImuSample&) {});
  std::size_t sweeps = 0;
  bool damaged = false;
  for (bool more = true; more;) {
    try {
      more = feed.next().has_value();
      sweeps += more ? 1 : 0;
    } catch (const InputError&) {
      damaged = true;
    }
  }
  EXPECT_TRUE(damaged);
  EXPECT_EQ(sweeps, 4U);
}

TEST(ImuMounting, ComesFromTheRecordingsTransforms) {
  StaticTransform to_imu{"base", "imu", Eigen::Isometry3d::Identity()};
  to_imu.T_parent_child.translation() << 1.0, 0.0, 0.0;
  StaticTransform to_lidar{"base", "lidar", Eigen::Isometry3d::Identity()};
  to_lidar.T_parent_child.translation() << 1.5, 0.0, 2.0;
  std::vector<Event> events = drive(1, [](int) { return true; });
  EXPECT_FALSE(recorded_mounting(EventList(events), 0, 1));
  for (const StaticTransform& transform : {to_imu, to_lidar}) {
    events.insert(events.begin(),
                  Event{.topic = 2, .received = milliseconds(0), .value = transform});
  }
  const auto mounting = recorded_mounting(EventList(events), 0, 1);
  ASSERT_TRUE(mounting);
  EXPECT_LE((mounting->translation() - Eigen::Vector3d(0.5, 0.0, 2.0)).norm(), 1e-12);
}

}  // namespace
}  // namespace adit
