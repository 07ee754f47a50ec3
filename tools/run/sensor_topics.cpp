// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/sensor_topics.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// The first topic of that kind, or the one that is named by the setting. None where there is none.
std::optional<std::size_t> choose_topic(const Recording& recording, TopicKind kind,
                                        const std::optional<std::string>& name,
                                        const std::string& setting, const std::string& sensor) {
  const std::vector<Topic>& topics = recording.topics();
  const auto found = std::ranges::find_if(topics, [&](const Topic& topic) {
    return topic.kind == kind && (!name || topic.name == *name);
  });
  if (found == topics.end() && name) {
    throw UsageError(setting + ": the recording has no " + sensor + " on '" + *name +
                     "'; adit inspect lists its topics.");
  }
  return found == topics.end() ? std::nullopt
                               : std::optional(static_cast<std::size_t>(found - topics.begin()));
}

}  // namespace

std::optional<std::size_t> imu_topic(const Recording& recording, const Config& config) {
  return config.imu.use ? choose_topic(recording, TopicKind::imu, config.recording.imu_topic,
                                       "recording.imu_topic", "IMU")
                        : std::nullopt;
}

std::optional<std::size_t> gnss_topic(const Recording& recording, const Config& config) {
  return config.gnss.use ? choose_topic(recording, TopicKind::gnss, config.recording.gnss_topic,
                                        "recording.gnss_topic", "GNSS receiver")
                         : std::nullopt;
}

}  // namespace adit
