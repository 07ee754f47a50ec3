// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/unchecked.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "adit/tools/recordings/ros_messages.hpp"

namespace adit {
namespace {

/// "/a, /b and 3 more".
std::string named(const std::vector<std::string>& topics) {
  constexpr std::size_t kNamed = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, topics.size()); ++i) {
    text += (i == 0 ? "" : ", ") + topics[i];
  }
  return topics.size() > kNamed ? text + " and " + std::to_string(topics.size() - kNamed) + " more"
                                : text;
}

/// What colours are made of: images and their calibrations.
bool is_of_camera(const Topic& topic) {
  return topic.type == ros::Image::kType || topic.type == ros::CompressedImage::kType ||
         topic.type == ros::CameraInfo::kType;
}

std::vector<std::string> topics_not_read(const Inspection& inspection, bool of_cameras) {
  std::vector<std::string> names;
  for (const Topic& topic : inspection.topics) {
    if (topic.kind == TopicKind::other && topic.messages.value_or(1) > 0 &&
        is_of_camera(topic) == of_cameras) {
      names.push_back(topic.name);
    }
  }
  return names;
}

bool is_mapped_with(TopicKind kind) {
  return kind == TopicKind::sweeps || kind == TopicKind::imu || kind == TopicKind::gnss ||
         kind == TopicKind::velocities || kind == TopicKind::headings;
}

/// Why the turns of an IMU were not compared with the sweeps'; empty where they were.
std::string why_not_compared(const Inspection& inspection, std::size_t imu_topic) {
  const auto check = std::ranges::find_if(
      inspection.motion, [&](const MotionCheck& one) { return one.pair.imu_topic == imu_topic; });
  if (check != inspection.motion.end()) {
    return check->comparison ? "" : "it turns too little, or too few sweeps could be aligned";
  }
  if (std::ranges::any_of(inspection.findings,
                          [](const Finding& one) { return one.kind == "no_device"; })) {
    return "there is no device to map on";
  }
  return "there are too few sweeps, or it has no angular velocities";
}

/// What the comparison leaves open of the mounting; empty where it leaves nothing.
std::string open_mounting(const MotionCheck& check) {
  if (!check.pair.R_range_gyro) {
    return "nothing says how it is mounted";
  }
  return check.comparison->mounting_sigma.allFinite() ? "" : "it does not turn about every axis";
}

}  // namespace

std::vector<std::string> unchecked(const Inspection& inspection) {
  std::vector<std::string> parts;
  const bool any_sweeps = std::ranges::any_of(
      inspection.topics, [](const Topic& topic) { return topic.kind == TopicKind::sweeps; });
  for (std::size_t i = 0; i < inspection.topics.size(); ++i) {
    const Topic& topic = inspection.topics[i];
    const TopicStatistics& statistics = inspection.statistics[i];
    if (statistics.events == 0) {
      continue;
    }
    if (topic.kind == TopicKind::sweeps && statistics.sweeps.with_times == 0) {
      parts.push_back("times of points on " + topic.name + " (there are none)");
    }
    if (is_mapped_with(topic.kind) && statistics.events > 1 &&
        !statistics.series.begin()->second.tells_gaps()) {
      parts.push_back("gaps on " + topic.name + " (there are too few messages)");
    }
    if (topic.kind == TopicKind::imu && any_sweeps) {
      const std::string reason = why_not_compared(inspection, i);
      if (!reason.empty()) {
        parts.push_back("clock and mounting of " + topic.name + " against the sweeps (" + reason +
                        ")");
      }
    }
  }
  for (const MotionCheck& check : inspection.motion) {
    const std::string reason = check.comparison ? open_mounting(check) : "";
    if (!reason.empty()) {
      parts.push_back("mounting of " + check.pair.imu.name + " (" + reason + ")");
    }
  }
  const std::vector<std::string> images = topics_not_read(inspection, true);
  if (!images.empty()) {
    parts.push_back("images and calibrations on " + named(images) +
                    " (adit export --colorize reads them)");
  }
  const std::vector<std::string> others = topics_not_read(inspection, false);
  if (!others.empty()) {
    parts.push_back("messages on " + named(others) + " (types that are not read)");
  }
  return parts;
}

std::string conclusion(const Inspection& inspection) {
  std::string text = has_problem(inspection) ? "" : "no fault found";
  const std::vector<std::string> parts = unchecked(inspection);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    text += i > 0 ? "; " : text.empty() ? "not checked: " : "; not checked: ";
    text += parts[i];
  }
  return text;
}

}  // namespace adit
