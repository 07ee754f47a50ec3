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

}  // namespace
}  // namespace adit
