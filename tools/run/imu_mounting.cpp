// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/imu_mounting.hpp"

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "adit/tools/topics/frame_tree.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kLookAhead = std::chrono::seconds(10);

/// Frame of the first message of a topic; empty where it has none or cannot be read.
std::string frame_of(const Recording& recording, std::size_t topic) {
  try {
    const std::optional<Event> first = recording.events({.topics = {topic}})->next();
    return first ? first->frame : "";
  } catch (const InputError&) {
    return "";  // whoever reads on reports it
  }
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
  try {
    const auto events = recording.events({.topics = topics});
    std::optional<Nanoseconds> begin;
    while (const std::optional<Event> event = events->next()) {
      begin = begin.value_or(event->received);
      if (event->received > *begin + kLookAhead) {
        break;
      }
      tree.add(std::get<StaticTransform>(event->value));
    }
  } catch (const InputError&) {
    return tree;  // whoever reads on reports it
  }
  return tree;
}

}  // namespace

std::optional<Eigen::Isometry3d> recorded_mounting(const Recording& recording,
                                                   std::size_t sweep_topic, std::size_t imu_topic) {
  const FrameTree tree = transforms_of(recording);
  if (tree.empty()) {
    return std::nullopt;
  }
  const std::string lidar = frame_of(recording, sweep_topic);
  const std::string imu = frame_of(recording, imu_topic);
  return lidar.empty() || imu.empty() ? std::nullopt : tree.transform(imu, lidar);
}

}  // namespace adit
