// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/recording_findings.hpp"

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

TEST(RecordingFindings, AGapIsFoundAmongFewSweepsToo) {
  EXPECT_TRUE(found_of({0, 100, 200, 300, 400}).empty());
  const std::vector<Finding> found = found_of({0, 100, 200, 29900, 30000});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, "gaps");
  EXPECT_NE(found[0].found.find("1 gap, the longest of 29.700 s"), std::string::npos)
      << found[0].found;
  EXPECT_TRUE(found_of({0, 100, 29900}).empty()) << "nothing tells which of the two is usual";
}

}  // namespace
}  // namespace adit
