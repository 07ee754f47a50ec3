// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/steady_stamps.hpp"

#include <chrono>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

/// Sweeps of a lidar, received 100 ms after their stamps but for those of some numbers.
std::vector<Event> sweeps(const std::map<int, Nanoseconds>& leaps, int count) {
  std::vector<Event> events;
  for (int i = 0; i < count; ++i) {
    Sweep sweep;
    sweep.stamp = std::chrono::seconds(1000) + i * milliseconds(100);
    Event event;
    event.received = sweep.stamp + milliseconds(100);
    const auto leap = leaps.find(i);
    sweep.stamp += leap == leaps.end() ? Nanoseconds(0) : leap->second;
    event.value = sweep;
    event.number = static_cast<std::size_t>(i);
    events.push_back(std::move(event));
  }
  return events;
}

/// The numbers of the sweeps that pass, and how many are reported.
std::pair<std::vector<std::size_t>, int> passed(const std::map<int, Nanoseconds>& leaps,
                                                int count) {
  const test::GivenRecording recording(
      {{"/points", "sensor_msgs/PointCloud2", TopicKind::sweeps, {}}}, sweeps(leaps, count));
  const auto stream = with_steady_stamps(recording.events({}), recording.topics(), "drive.mcap");
  std::pair<std::vector<std::size_t>, int> result;
  while (true) {
    try {
      const auto event = stream->next();
      if (!event) {
        return result;
      }
      result.first.push_back(*event->number);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("its stamp lies"), std::string::npos);
      ++result.second;
    }
  }
}

using Numbers = std::vector<std::size_t>;

TEST(SteadyStamps, PassWhatIsSteady) {
  EXPECT_EQ(passed({{2, milliseconds(4000)}}, 5), std::pair(Numbers({0, 1, 2, 3, 4}), 0));
}

TEST(SteadyStamps, LeaveOutWhatLeapsAlone) {
  const auto hour = std::chrono::hours(1);
  EXPECT_EQ(passed({{2, hour}}, 5), std::pair(Numbers({0, 1, 3, 4}), 1));
  EXPECT_EQ(passed({{2, hour}, {3, -hour}}, 6), std::pair(Numbers({0, 1, 4, 5}), 2));
  EXPECT_EQ(passed({{4, hour}}, 5), std::pair(Numbers({0, 1, 2, 3}), 1));
  EXPECT_EQ(passed({{2, Nanoseconds::max() - std::chrono::seconds(5000)}}, 5),
            std::pair(Numbers({0, 1, 3, 4}), 1));
}

TEST(SteadyStamps, PassAClockThatWasSet) {
  const auto back = -std::chrono::hours(1);
  EXPECT_EQ(passed({{2, back}, {3, back}, {4, back}, {5, back}}, 6),
            std::pair(Numbers({0, 1, 2, 3, 4, 5}), 0));
}

}  // namespace
}  // namespace adit
