// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/imu_mounting.hpp"

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "tools/recordings/tolerant_recording.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kLookAhead = std::chrono::seconds(10);

/// Frame of the first message of a topic that can be read; empty where it has none.
std::string frame_of(const Recording& recording, std::size_t topic) {
  const std::optional<Event> first = recording.events({.topics = {topic}})->next();
  return first ? first->frame : "";
}

FrameTree transforms_of(const Recording& recording) {
  FrameTree tree;
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (recording.topics()[i].kind == TopicKind::transforms) {
      topics.push_back(i);
    }
  }
  if (topics.empty()) {
    return tree;
  }
  const auto events = recording.events({.topics = topics});
  std::optional<Nanoseconds> begin;
  while (const std::optional<Event> event = events->next()) {
    begin = begin.value_or(event->received);
    if (event->received > *begin + kLookAhead) {
      break;
    }
    tree.add(std::get<StaticTransform>(event->value));
  }
  return tree;
}

}  // namespace

std::optional<Eigen::Isometry3d> recorded_mounting(const Recording& recording,
                                                   std::size_t sweep_topic, std::size_t imu_topic) {
  // Whoever reads on reports the damage.
  const auto whole = pass_over_damage(recording, [](const InputError&) {});
  const FrameTree tree = transforms_of(*whole);
  if (tree.empty()) {
    return std::nullopt;
  }
  const std::string lidar = frame_of(*whole, sweep_topic);
  const std::string imu = frame_of(*whole, imu_topic);
  return lidar.empty() || imu.empty() ? std::nullopt : tree.transform(imu, lidar);
}

std::vector<Finding> find_unknown_mountings(const std::vector<Topic>& topics,
                                            const std::vector<TopicStatistics>& statistics,
                                            const FrameTree& frames) {
  std::vector<Finding> findings;
  const auto sweeps = std::ranges::find(topics, TopicKind::sweeps, &Topic::kind);
  if (sweeps == topics.end()) {
    return findings;
  }
  const std::string& lidar = statistics[static_cast<std::size_t>(sweeps - topics.begin())].frame;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    // Without a gyroscope it is not used.
    if (topics[i].kind != TopicKind::imu || statistics[i].imu.rotation.count == 0 ||
        frames.transform(lidar, statistics[i].frame)) {
      continue;
    }
    findings.push_back(
        {Severity::notice, "mounting_unknown", topics[i].name,
         "no transform in it leads from '" + lidar + "', the frame of " + sweeps->name + ", to '" +
             statistics[i].frame + "', the IMU's",
         "the IMU's axes are taken for the range sensor's; where they are not, "
         "mapping with it fails at the first turn",
         "Record /tf_static, or set imu.T_imu_lidar; --write-config writes the rotation "
         "that the motion shows"});
  }
  return findings;
}

}  // namespace adit
