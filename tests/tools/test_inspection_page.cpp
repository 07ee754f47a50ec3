// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/inspection_page.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "adit/tests/tools/inspect_support.hpp"
#include "adit/tests/tools/run_support.hpp"

namespace adit {
namespace {

using test::count;

std::string page_of(const std::vector<test::Recorded>& events) {
  const test::TemporaryFolder folder;
  InspectCommandOptions options;
  options.recording = test::write(folder, events);
  options.html = folder / "page.html";
  std::ostringstream out;
  std::ostringstream err;
  inspect_command(options, out, err);
  EXPECT_EQ(err.str(), "");
  return test::content(folder / "page.html");
}

std::size_t gaps_marked(const std::string& page) {
  return count(page, " r=\"3.5");
}

TEST(InspectionPage, NeedsNothingElseAndDrawsEveryTopic) {
  const std::string page = page_of(test::clean_recording());
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_EQ(count(page, "<svg"), 12U) << "three topics last; the IMU, the "
                                         "stretch that was mapped, and the turns; "
                                         "each for a desktop and for a telephone";
  for (const char* part :
       {"At rest, or moving evenly", "Angular velocity (rad/s", ">gravity<",
        "Up by the accelerometer, off the z of the range sensor", "Directions held by matches",
        "Turned by the sweeps (mrad", "Turned by the gyroscope", "Their difference (mrad"}) {
    EXPECT_EQ(count(page, part), 2U) << part;
  }
  EXPECT_EQ(count(page, "the gyroscope's bias"), 0U) << "it is never at rest";
  EXPECT_EQ(count(page, "<svg"), count(page, "</svg>"));
  EXPECT_EQ(count(page, "src="), 0U);
  EXPECT_EQ(count(page, "href="), 0U);
  EXPECT_EQ(count(page, "no fault found"), 1U);
  EXPECT_EQ(gaps_marked(page), 0U);
  for (const char* bad : {"NaN", "nan", "inf"}) {
    const std::size_t at = page.find(std::string("=\"") + bad);
    EXPECT_EQ(at, std::string::npos) << page.substr(at == page.npos ? 0 : at - 100, 200);
    EXPECT_EQ(count(page, std::string(",") + bad), 0U);
  }
}

TEST(InspectionPage, GapsAreMarkedAndNamed) {
  std::vector<test::Recorded> events = test::clean_recording();
  std::erase_if(events, [](const test::Recorded& event) {
    const Nanoseconds at = event.received - test::MovingRig::kBegin;
    return event.topic == "/imu" && at > std::chrono::seconds(2) &&
           at < std::chrono::milliseconds(2200);
  });
  const std::string page = page_of(events);
  EXPECT_EQ(gaps_marked(page), 2U) << "on a desktop and on a telephone";
  EXPECT_EQ(count(page, "1 gap, the longest of 0.2"), 1U);
  EXPECT_EQ(count(page, "no fault found"), 0U);
}

TEST(InspectionPage, FramesThatComeMoreSeldomThanOthersOfTheirTopicAreNoGaps) {
  std::vector<test::Recorded> events = test::clean_recording();
  const Nanoseconds begin = events.front().received;
  for (int i = 0; i < 300; ++i) {
    const Nanoseconds at = begin + std::chrono::milliseconds(20LL * i);
    events.push_back({"/tf", at, ReferencePose{at, "map", "odom", Eigen::Isometry3d::Identity()}});
    if (i % 5 == 0) {
      events.push_back({"/tf", at, ReferencePose{at, "map", "imu", Eigen::Isometry3d::Identity()}});
    }
  }
  std::ranges::stable_sort(events, {}, &test::Recorded::received);
  EXPECT_EQ(gaps_marked(page_of(events)), 0U);
}

TEST(TopicTimeline, KeepsAllEventsInFewBins) {
  TopicTimeline timeline;
  for (int i = 0; i < 100000; ++i) {
    timeline.add(std::chrono::milliseconds(50LL * i),
                 one_event(i == 5000 ? 3.0 : 0.05, 0.001 * (i % 7)));
  }
  EXPECT_LE(timeline.bins().size(), 1000U);
  EXPECT_GE(timeline.bins().size(), 500U);
  EXPECT_NEAR(timeline.bin_width() * static_cast<double>(timeline.bins().size()), 5000.0,
              timeline.bin_width());
  double events = 0.0;
  double longest = 0.0;
  for (const TopicTimeline::Bin& bin : timeline.bins()) {
    events += bin.events;
    longest = std::max(longest, bin.largest_interval);
    EXPECT_NEAR(bin.greatest_delay, 0.006, 1e-12);
    EXPECT_EQ(bin.least_delay, 0.0);
  }
  EXPECT_EQ(events, 100000.0);
  EXPECT_EQ(longest, 3.0);
}

}  // namespace
}  // namespace adit
