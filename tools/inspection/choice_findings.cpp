// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/choice_findings.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/setup/static_transforms.hpp"

namespace adit {
namespace {

Finding handled(std::string kind, std::string topic, std::string found, const std::string& how,
                std::string remedy = "Nothing need be done") {
  return {Severity::notice,
          std::move(kind),
          std::move(topic),
          std::move(found),
          "handled automatically: " + how,
          std::move(remedy)};
}

/// "'front' (40), 'rear' (20)".
std::string frames_text(const TopicStatistics& statistics) {
  std::string text;
  for (const auto& [frame, one] : statistics.series) {
    text += fmt::format("{}'{}' ({})", text.empty() ? "" : ", ", frame, one.events);
  }
  return text;
}

std::string setting_of_frame(TopicKind kind) {
  return kind == TopicKind::sweeps ? "recording.sweep_frame chooses another"
         : kind == TopicKind::imu  ? "recording.imu_frame chooses another"
                                   : "Record each sensor on a topic of its own";
}

}  // namespace

std::vector<Finding> find_in_choices(const Inspection& inspection) {
  std::vector<Finding> findings;
  for (const PassedOver& one : inspection.sensors.passed_over) {
    findings.push_back(handled("topic_passed_over", one.topic, one.why, "a run does not use it",
                               "recording.sweep_topic, imu_topic and gnss_topic choose others"));
  }
  for (const auto& [topic, frame] : inspection.sensors.frames) {
    const TopicStatistics& statistics = inspection.statistics[topic];
    const auto named = std::ranges::count_if(
        statistics.series, [](const auto& series) { return !series.first.empty(); });
    if (named > 1) {
      findings.push_back(
          handled("several_frames", inspection.topics[topic].name,
                  "sensors of several frames share the topic: " + frames_text(statistics),
                  "a run uses '" + frame + "', and another one only after that has fallen silent",
                  setting_of_frame(inspection.topics[topic].kind)));
    }
  }
  return findings;
}

std::vector<Finding> find_in_transforms(const Inspection& inspection) {
  std::vector<Finding> findings;
  for (const IgnoredTransform& ignored : inspection.frames.ignored()) {
    findings.push_back(handled("transform_ignored", "", describe(ignored),
                               "a run ignores it and uses the others", "Correct its publisher"));
  }
  if (!inspection.scaled.empty()) {
    findings.push_back(handled("scaled_quaternion", "",
                               "static transforms have quaternions that are not of length 1: " +
                                   names_of(inspection.scaled),
                               "they are normalised", "Correct their publisher"));
  }
  const RecordedTransforms& transforms = inspection.sensors.transforms;
  if (!transforms.constant.empty()) {
    findings.push_back(handled("constant_transforms", "",
                               "/tf_static does not connect the sensors, and transforms that stay "
                               "constant on /tf do: " +
                                   names_of(transforms.constant),
                               "a run takes them for static", "Record /tf_static to be sure"));
  }
  if (!inspection.sweeps) {
    return findings;
  }
  const auto frame_of = [&](std::size_t topic) {
    const auto chosen = inspection.sensors.frames.find(topic);
    return chosen == inspection.sensors.frames.end() ? std::string() : chosen->second;
  };
  const std::string lidar = frame_of(*inspection.sweeps);
  for (const std::optional<std::size_t>& topic :
       {inspection.sensors.imu, inspection.sensors.gnss, inspection.sensors.velocity,
        inspection.sensors.heading}) {
    const std::string frame = topic ? frame_of(*topic) : "";
    const auto conflict =
        lidar.empty() || frame.empty() ? std::nullopt : inspection.frames.conflict(frame, lidar);
    if (conflict) {
      findings.push_back({Severity::problem, "mounting_ambiguous", inspection.topics[*topic].name,
                          describe(*conflict, "'" + frame + "' on '" + lidar + "'"),
                          "a run uses the shortest chain of transforms, and the latest of equals; "
                          "if that is wrong, mapping with this sensor fails",
                          "Correct the transforms, or set imu.T_imu_lidar, gnss.antenna, "
                          "velocity.T_lidar_sensor or gnss.heading_mounting"});
    }
  }
  return findings;
}

}  // namespace adit
