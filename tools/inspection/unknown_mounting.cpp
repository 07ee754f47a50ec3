// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/unknown_mounting.hpp"

#include <algorithm>
#include <cstddef>
#include <string>

namespace adit {

std::vector<Finding> find_unknown_mountings(const std::vector<Topic>& topics,
                                            const std::vector<TopicStatistics>& statistics,
                                            const FrameTree& frames,
                                            std::optional<std::size_t> range) {
  std::vector<Finding> findings;
  if (!range) {
    return findings;
  }
  const Topic& sweeps = topics[*range];
  const std::string& lidar = statistics[*range].frame;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    // Without a gyroscope it is not used.
    if (topics[i].kind != TopicKind::imu || statistics[i].imu.rotation.count == 0 ||
        frames.transform(lidar, statistics[i].frame)) {
      continue;
    }
    findings.push_back(
        {Severity::notice, "mounting_unknown", topics[i].name,
         "no transform in it leads from '" + lidar + "', the frame of " + sweeps.name + ", to '" +
             statistics[i].frame + "', the IMU's",
         "the IMU's axes are taken for the range sensor's; where they are not, "
         "mapping with it fails at the first turn",
         "Record /tf_static, or set imu.T_imu_lidar; --write-config writes the rotation "
         "that the motion shows"});
  }
  return findings;
}

}  // namespace adit
