// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/inspection.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <memory>
#include <utility>

#include "adit/engine/error.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/tools/inspection/choice_findings.hpp"
#include "adit/tools/inspection/clock_drift.hpp"
#include "adit/tools/inspection/rotation_profile.hpp"
#include "adit/tools/inspection/unknown_mounting.hpp"
#include "adit/tools/recordings/one_sensor.hpp"
#include "adit/tools/setup/configured_recording.hpp"

namespace adit {
namespace {

constexpr std::size_t kListedErrors = 10;
constexpr Nanoseconds kStretch = std::chrono::seconds(20);
constexpr uint64_t kLeastSweeps = 20;  // for a comparison

using Profiles = std::map<std::size_t, RotationProfile>;  // by topic

void add_if_scaled(const StaticTransform& transform, std::vector<StaticTransform>& scaled) {
  const bool known = std::ranges::any_of(scaled, [&](const StaticTransform& one) {
    return one.parent == transform.parent && one.child == transform.child;
  });
  if (is_scaled(transform) && !known && scaled.size() < kListedErrors) {
    scaled.push_back(transform);
  }
}

/// As a run chooses them; where it would ask for a choice, the first topic that has sweeps.
void choose_topics(const Recording& recording, const std::filesystem::path& path, Config config,
                   Inspection& result) {
  const auto forget_unknown = [&](std::optional<std::string>& name) {
    if (name && std::ranges::find(result.topics, *name, &Topic::name) == result.topics.end()) {
      name.reset();  // the configuration of another recording
    }
  };
  forget_unknown(config.recording.imu_topic);
  forget_unknown(config.recording.gnss_topic);
  forget_unknown(config.recording.velocity_topic);
  forget_unknown(config.recording.heading_topic);
  const auto is_unknown = [&](const std::string& name) {
    return std::ranges::find(result.topics, name, &Topic::name) == result.topics.end();
  };
  if (std::ranges::any_of(config.recording.further_sweep_topics, is_unknown)) {
    config.recording.further_sweep_topics.clear();
  }
  try {
    result.sweeps = sweep_topic(recording, path, config.recording.sweep_topic);
  } catch (const InputError&) {
    for (std::size_t i = result.topics.size(); i-- > 0 && !config.recording.sweep_topic;) {
      if (result.topics[i].kind == TopicKind::sweeps && result.topics[i].messages != 0U) {
        result.sweeps = i;
      }
    }
  }
  if (!result.sweeps) {
    return;
  }
  result.sensors = choose_sensors(recording, *result.sweeps, config);
}

/// Reads it to the end; what is damaged becomes findings.
Profiles read_all(const Recording& recording, Inspection& result) {
  Profiles profiles;
  uint64_t errors = 0;
  const auto events = recording.events(
      {.velocities_of = result.sensors.velocity, .headings_of = result.sensors.heading});
  for (bool more = true; more;) {
    try {
      const std::optional<Event> event = events->next();
      more = event.has_value();
      if (!event) {
        break;
      }
      result.statistics[event->topic].add(*event);
      if (const auto* sample = std::get_if<ImuSample>(&event->value);
          sample != nullptr && !sample->angular_velocity.array().isNaN().any()) {
        profiles[event->topic].add(event->received, sample->angular_velocity);
      } else if (const auto* transform = std::get_if<StaticTransform>(&event->value)) {
        result.frames.add(*transform);
        add_if_scaled(*transform, result.scaled);
      }
    } catch (const InputError& error) {
      if (++errors <= kListedErrors) {
        result.findings.push_back(damage_finding(error));
      }
    }
  }
  if (errors > kListedErrors) {
    result.findings.push_back({Severity::problem, "damage", "",
                               std::to_string(errors - kListedErrors) + " more damaged places", "",
                               ""});
  }
  return profiles;
}

/// The sweeps that a run maps with each IMU.
std::vector<MotionPair> pairs_to_check(const Inspection& inspection, const Profiles& profiles,
                                       const Config& config) {
  std::vector<MotionPair> pairs;
  if (!inspection.sweeps) {
    return pairs;
  }
  const std::size_t sweep_topic = *inspection.sweeps;
  const TopicStatistics& range = inspection.statistics[sweep_topic];
  for (const auto& [topic, profile] : profiles) {
    const std::optional<TimeSpan> stretch = profile.liveliest(kStretch);
    if (!stretch || range.events < kLeastSweeps) {
      continue;
    }
    MotionPair pair{.sweeps = inspection.topics[sweep_topic],
                    .sweep_topic = sweep_topic,
                    .imu = inspection.topics[topic],
                    .imu_topic = topic,
                    .stretch = *stretch,
                    .trust_point_times = range.point_times_fit(),
                    .R_range_gyro = std::nullopt};
    const std::string& imu_frame = inspection.statistics[topic].frame;
    if (config.imu.T_imu_lidar) {
      pair.R_range_gyro = pose_of(*config.imu.T_imu_lidar).linear().transpose();
      pair.told_by = std::string("imu.T_imu_lidar");
    } else if (inspection.frames.knows(range.frame) && inspection.frames.knows(imu_frame)) {
      if (const auto T = inspection.frames.transform(range.frame, imu_frame)) {
        pair.R_range_gyro = T->linear();
      }
    }
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

/// Maps the stretch of each pair on the device, and with what the first range sensor has mapped
/// compares what the others see.
void compare_sensors(const Recording& recording, const std::vector<MotionPair>& pairs,
                     const Config& config, const DeviceOptions& device, Inspection& result) {
  const std::vector<MergedTopic>& lidars = result.sensors.sweeps;
  if (pairs.empty() && lidars.size() < 2) {
    return;
  }
  try {
    DeviceSession session(device);
    // Sweeps are aligned with the second before. Where their points have times they are de-skewed
    // at constant velocity; where these may be wrong all are skewed alike.
    Config alone = config;
    alone.submap = {.l = 10, .delta_trans = 0.0, .delta_rot = 0.0};
    for (const MotionPair& pair : pairs) {
      alone.preprocess.deskew = pair.trust_point_times;
      Odometry odometry(session.context(), alone);
      result.motion.push_back(
          check_motion(recording, pair, [&](const Sweep& sweep) { return odometry.step(sweep); }));
    }
    for (std::size_t i = 1; i < lidars.size(); ++i) {
      result.lidars.push_back(
          check_lidar_mounting(recording, lidars.front(), lidars[i], config, session.context()));
    }
    session.require_no_complaints();
  } catch (const engine::Error& error) {
    result.findings.push_back({Severity::notice, "no_device", "",
                               std::string("rotations were not compared: ") + error.what(),
                               "an offset between the sensors' clocks of less than a second, or a "
                               "wrong mounting, is not found",
                               "`adit devices` tells what is missing"});
  }
}

/// By topic: a run does not pass over it. Velocities and headings are used only where a setting
/// names them.
std::vector<bool> used_topics(const Inspection& inspection) {
  std::vector<bool> used;
  for (std::size_t i = 0; i < inspection.topics.size(); ++i) {
    const Topic& topic = inspection.topics[i];
    const bool unnamed =
        (topic.kind == TopicKind::velocities && inspection.sensors.velocity != i) ||
        (topic.kind == TopicKind::headings && inspection.sensors.heading != i);
    used.push_back(!unnamed &&
                   std::ranges::find(inspection.sensors.passed_over, topic.name,
                                     &PassedOver::topic) == inspection.sensors.passed_over.end());
  }
  return used;
}

/// What is wrong with topics that a run passes over does not make it worse.
void excuse_unused_topics(Inspection& inspection) {
  const std::vector<bool> used = used_topics(inspection);
  const auto is_unused = [&](const Finding& finding) {
    const auto topic = std::ranges::find(inspection.topics, finding.topic, &Topic::name);
    return topic != inspection.topics.end() &&
           !used[static_cast<std::size_t>(topic - inspection.topics.begin())];
  };
  std::erase_if(inspection.findings, [&](const Finding& finding) {
    return finding.kind == "mounting_unknown" && is_unused(finding);
  });
  for (Finding& finding : inspection.findings) {
    if (finding.severity == Severity::problem && is_unused(finding)) {
      finding.severity = Severity::notice;
      finding.effect = "none, a run does not use the topic";
    }
  }
}

}  // namespace

Inspection inspect(const std::vector<std::filesystem::path>& paths, const Config& config,
                   const DeviceOptions& device) {
  const std::unique_ptr<Recording> recording = open_recording(paths, config.recording);
  Inspection result;
  result.description = recording->description();
  result.topics = recording->topics();
  result.statistics.resize(result.topics.size());
  choose_topics(*recording, paths.front(), config, result);
  const Profiles profiles = read_all(*recording, result);
  for (const StaticTransform& transform : result.sensors.transforms.constant) {
    result.frames.add(transform);
  }
  const OneSensorRecording mapped(*recording, result.sensors.frames);
  compare_sensors(mapped, pairs_to_check(result, profiles, config), config, device, result);

  const auto add = [&](std::vector<Finding> found) {
    std::ranges::move(found, std::back_inserter(result.findings));
  };
  if (recording->times_are_assumed()) {
    add({{Severity::notice, "assumed_times", "", "nothing in it tells the times of the sweeps",
          "10 Hz is assumed, and speeds are as wrong as that", "Add a times.txt"}});
  }
  for (const RecordingNotice& notice : recording->notices()) {
    add({{Severity::notice, notice.kind, "", notice.found, notice.effect, notice.remedy}});
  }
  add(find_in_recording(result.topics));
  const bool simulated = has_simulated_time(result.topics);
  add(find_in_choices(result));
  add(find_in_transforms(result));
  if (config.imu.T_imu_lidar == ImuConfig{}.T_imu_lidar) {
    add(find_unknown_mountings(result.topics, result.statistics, result.frames, result.sweeps));
  }
  const OtherTopics others{
      .simulated_time = simulated,
      .shared_clock = share_a_clock(result.topics, result.statistics, used_topics(result)),
      .range_frame = result.sweeps ? result.statistics[*result.sweeps].frame : ""};
  for (std::size_t i = 0; i < result.topics.size(); ++i) {
    add(find_in_topic(result.topics[i], result.statistics[i], result.frames, others));
  }
  if (!simulated) {
    add(find_clock_drift(result.topics, result.statistics, result.sweeps));
  }
  for (const MotionCheck& check : result.motion) {
    add(find_in_motion(check));
  }
  for (const LidarMounting& mounting : result.lidars) {
    add(find_in_mounting(mounting));
  }
  excuse_unused_topics(result);
  return result;
}

bool has_problem(const Inspection& inspection) {
  return std::ranges::any_of(inspection.findings,
                             [](const Finding& f) { return f.severity == Severity::problem; });
}

}  // namespace adit
