// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/sensor_topics.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/recordings/ros_messages.hpp"
#include "adit/tools/recordings/topic_survey.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// Rates that differ by less are the same: drivers drop messages.
constexpr double kHigherRate = 1.2;
constexpr const char* kNoMessages = "it has no messages";

/// The messages of a topic from one frame.
struct SensorCandidate {
  std::size_t topic = 0;
  SensorSample sample{};
  bool connected = false;  ///< by transforms with the frame of the sweeps
};

struct CandidateList {
  std::vector<SensorCandidate> candidates{};
  std::vector<PassedOver> silent{};  ///< topics without messages
};

void add_candidates(const Recording& recording, std::size_t topic, CandidateList& list,
                    bool headings = false) {
  if (recording.topics()[topic].messages == 0U) {
    list.silent.push_back({recording.topics()[topic].name, kNoMessages});
    return;
  }
  std::vector<SensorSample> samples = first_samples(recording, topic, headings);
  if (samples.empty()) {
    samples.emplace_back().fault = "not one of its first messages can be read";
  }
  for (SensorSample& sample : samples) {
    list.candidates.push_back({.topic = topic, .sample = std::move(sample)});
  }
}

/// Those of that kind, or of the topic that is named by the setting.
CandidateList candidates_of(const Recording& recording, TopicKind kind,
                            const std::optional<std::string>& name, const std::string& setting,
                            const std::string& sensor) {
  CandidateList list;
  bool found = false;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    const Topic& topic = recording.topics()[i];
    if (topic.kind == kind && (!name || topic.name == *name)) {
      found = true;
      add_candidates(recording, i, list);
    }
  }
  if (!found && name) {
    const auto other = std::ranges::find(recording.topics(), *name, &Topic::name);
    throw UsageError(setting + ": the recording has no " + sensor + " on '" + *name + "'" +
                     (other == recording.topics().end() ? "" : ", which has " + other->type) +
                     "; adit inspect lists its topics.");
  }
  return list;
}

/// The topics that the setting names of those that `has` takes; throws UsageError where there are
/// none. `what` they have, for people.
CandidateList named_topics(const Recording& recording, const std::string& name,
                           const std::string& setting, const std::string& what,
                           bool (*has)(const Topic&)) {
  CandidateList list;
  std::string known;
  std::string type;
  bool found = false;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    const Topic& topic = recording.topics()[i];
    if (has(topic)) {
      known += (known.empty() ? "" : ", ") + topic.name;
    }
    if (topic.name != name) {
      continue;
    }
    type = topic.type;
    if (has(topic)) {
      found = true;
      add_candidates(recording, i, list, has == has_headings);
    }
  }
  if (!found) {
    throw UsageError(setting + ": the recording has no " + what + " on '" + name + "'" +
                     (type.empty() ? "" : ", which has " + type) + "; " +
                     (known.empty() ? "it has none" : "it has " + what + " on " + known) + ".");
  }
  return list;
}

/// The topics of sweeps that are merged with those of `first`, by their names.
std::vector<std::size_t> further_sweeps(const Recording& recording, std::size_t first,
                                        const RecordingConfig& config) {
  std::vector<std::size_t> further;
  for (const std::string& name : config.further_sweep_topics) {
    const auto found = std::ranges::find_if(recording.topics(), [&](const Topic& topic) {
      return topic.name == name && topic.kind == TopicKind::sweeps;
    });
    const auto topic = static_cast<std::size_t>(found - recording.topics().begin());
    if (found == recording.topics().end()) {
      throw UsageError("recording.further_sweep_topics: the recording has no sweeps on '" + name +
                       "'; adit inspect lists its topics.");
    }
    if (topic == first || std::ranges::count(further, topic) > 0) {
      throw UsageError("recording.further_sweep_topics: '" + name + "' is named twice.");
    }
    further.push_back(topic);
  }
  return further;
}

/// How the further sensor `i` is mounted on the first.
Eigen::Isometry3d mounting_of(std::size_t i, const std::string& lidar, const std::string& frame,
                              const FrameTree& tree, const RecordingConfig& config) {
  if (i < config.T_lidar_further.size()) {
    return pose_of(config.T_lidar_further[i]);
  }
  const bool named = !lidar.empty() && !frame.empty();
  const auto found = !named ? std::nullopt
                     : lidar == frame
                         ? std::optional(Eigen::Isometry3d(Eigen::Isometry3d::Identity()))
                         : tree.transform(lidar, frame);
  if (!found) {
    throw UsageError("recording.further_sweep_topics: " +
                     (named ? "no transform connects '" + frame + "', the frame of " +
                                  config.further_sweep_topics[i] + ", with '" + lidar + "'"
                            : "a frame is not named, of " + config.further_sweep_topics[i] +
                                  " or of the first sensor") +
                     ". Give the pose of the sensor in the first one's axes: --set "
                     "'recording.T_lidar_further=[[x, y, z, qx, qy, qz, qw]]'.");
  }
  // By its numbers, so that the same setting gives the same bytes.
  return pose_of(numbers_of(*found));
}

/// Leaves those of other frames out. A frame that is not among the first messages may come later.
void keep_named(CandidateList& list, const std::optional<std::string>& frame) {
  if (!frame || list.candidates.empty()) {
    return;
  }
  SensorCandidate other = list.candidates.front();
  other.sample.frame = plain_frame(*frame);
  std::erase_if(list.candidates,
                [&](const SensorCandidate& one) { return one.sample.frame != other.sample.frame; });
  if (list.candidates.empty()) {
    list.candidates.push_back(std::move(other));
  }
}

/// Why `one` is not used where `best` is; empty where it would be the better choice.
std::string why_passed_over(const SensorCandidate& one, const SensorCandidate& best,
                            const std::string& best_name) {
  if (one.sample.fault.empty() != best.sample.fault.empty()) {
    return one.sample.fault;
  }
  if (one.connected != best.connected) {
    return one.connected ? ""
                         : "no transform connects its frame '" + one.sample.frame +
                               "' with the range sensor's";
  }
  const double rate = one.sample.rate;
  if (best.sample.rate > kHigherRate * rate || rate > kHigherRate * best.sample.rate) {
    return rate > best.sample.rate ? ""
                                   : fmt::format("its rate is {:.0f} Hz, that of {} {:.0f} Hz",
                                                 rate, best_name, best.sample.rate);
  }
  return best_name + " is as good";
}

/// None where there are no candidates. Says of the others why they are not used.
std::optional<SensorCandidate> best_of(const Recording& recording, const CandidateList& list,
                                       std::vector<PassedOver>& passed_over) {
  std::optional<SensorCandidate> best;
  const auto name = [&](const SensorCandidate& one) { return recording.topics()[one.topic].name; };
  for (const SensorCandidate& one : list.candidates) {
    if (!best || why_passed_over(one, *best, name(*best)).empty()) {
      best = one;
    }
  }
  passed_over.insert(passed_over.end(), list.silent.begin(), list.silent.end());
  for (const SensorCandidate& one : list.candidates) {
    const bool itself = one.topic == best->topic && one.sample.frame == best->sample.frame;
    if (!itself) {
      const std::string of_frame =
          one.topic == best->topic ? ", frame '" + one.sample.frame + "'" : "";
      passed_over.push_back({name(one) + of_frame, why_passed_over(one, *best, name(*best))});
    }
  }
  return best;
}

/// The topics of sweeps besides `sweeps` that no run can use.
std::vector<PassedOver> unusable_sweeps(const Recording& recording, std::size_t sweeps) {
  std::vector<PassedOver> unusable;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    const Topic& topic = recording.topics()[i];
    if (topic.kind == TopicKind::sweeps && i != sweeps) {
      const std::string why = topic.messages == 0U ? kNoMessages : fault_of_topic(recording, i);
      if (!why.empty()) {
        unusable.push_back({topic.name, why});
      }
    }
  }
  return unusable;
}

}  // namespace

bool has_velocities(const Topic& topic) {
  return topic.kind == TopicKind::velocities ||
         (topic.kind == TopicKind::poses &&
          (topic.type == ros::Odometry::kType || topic.type == ros::PoseStamped::kType));
}

bool has_headings(const Topic& topic) {
  return topic.kind == TopicKind::headings ||
         (topic.kind == TopicKind::imu && topic.type == ros::Imu::kType);
}

RecordedSensors choose_sensors(const Recording& recording, std::size_t sweeps,
                               const Config& config) {
  RecordedSensors chosen;
  const auto keep_frame = [&](std::size_t topic, const std::string& frame) {
    if (!frame.empty()) {
      chosen.frames[topic] = frame;
    }
  };
  chosen.passed_over = unusable_sweeps(recording, sweeps);
  const std::vector<SensorSample> range = first_samples(recording, sweeps);
  const std::string lidar = config.recording.sweep_frame
                                ? plain_frame(*config.recording.sweep_frame)
                            : range.empty() ? ""
                                            : range.front().frame;
  keep_frame(sweeps, lidar);
  const std::vector<std::size_t> further = further_sweeps(recording, sweeps, config.recording);
  std::vector<std::string> frames{lidar};
  for (const std::size_t topic : further) {
    const std::vector<SensorSample> samples = first_samples(recording, topic);
    keep_frame(topic, frames.emplace_back(samples.empty() ? "" : samples.front().frame));
  }
  CandidateList imus;
  if (config.imu.use) {
    imus = candidates_of(recording, TopicKind::imu, config.recording.imu_topic,
                         "recording.imu_topic", "IMU");
    keep_named(imus, config.recording.imu_frame);
  }
  CandidateList receivers;
  if (config.gnss.use) {
    receivers = candidates_of(recording, TopicKind::gnss, config.recording.gnss_topic,
                              "recording.gnss_topic", "GNSS receiver");
  }
  CandidateList velocities;
  if (config.velocity.use && config.recording.velocity_topic) {
    velocities = named_topics(recording, *config.recording.velocity_topic,
                              "recording.velocity_topic", "velocities", has_velocities);
  }
  CandidateList headings;
  if (config.gnss.use && config.gnss.heading && config.recording.heading_topic) {
    headings = named_topics(recording, *config.recording.heading_topic, "recording.heading_topic",
                            "headings", has_headings);
  }
  const std::vector<std::string> of_lidars = frames;
  for (const CandidateList* list : {&imus, &receivers, &velocities, &headings}) {
    for (const SensorCandidate& one : list->candidates) {
      frames.push_back(one.sample.frame);
    }
  }
  chosen.transforms = recorded_transforms(recording, frames);
  const FrameTree tree = frame_tree_of(chosen.transforms);
  const MergedSensor of_range{.c_min = config.preprocess.c_min, .c_max = config.preprocess.c_max};
  chosen.sweeps = {{.topic = sweeps, .frame = lidar, .sensor = of_range}};
  for (std::size_t i = 0; i < further.size(); ++i) {
    MergedTopic& one = chosen.sweeps.emplace_back(further[i], of_lidars[i + 1], of_range);
    one.sensor.T_lidar_sensor = mounting_of(i, lidar, one.frame, tree, config.recording);
  }
  const auto is_connected = [&](const SensorCandidate& one) {
    return !lidar.empty() && !one.sample.frame.empty() &&
           tree.transform(lidar, one.sample.frame).has_value();
  };
  for (SensorCandidate& one : imus.candidates) {
    one.connected = config.imu.T_imu_lidar || is_connected(one);
  }
  for (SensorCandidate& one : velocities.candidates) {
    one.connected = config.velocity.T_lidar_sensor || is_connected(one);
  }
  for (SensorCandidate& one : receivers.candidates) {
    one.sample.rate = 0.0;  // a slower receiver is no worse
  }
  for (SensorCandidate& one : headings.candidates) {
    one.connected = config.gnss.heading_mounting || is_connected(one);
  }
  if (const auto heading = best_of(recording, headings, chosen.passed_over)) {
    chosen.heading = heading->topic;
    keep_frame(heading->topic, heading->sample.frame);
  }
  if (const auto imu = best_of(recording, imus, chosen.passed_over)) {
    chosen.imu = imu->topic;
    keep_frame(imu->topic, imu->sample.frame);
  }
  if (const auto receiver = best_of(recording, receivers, chosen.passed_over)) {
    chosen.gnss = receiver->topic;
    keep_frame(receiver->topic, receiver->sample.frame);
  }
  if (const auto velocity = best_of(recording, velocities, chosen.passed_over)) {
    chosen.velocity = velocity->topic;
    keep_frame(velocity->topic, velocity->sample.frame);
  }
  return chosen;
}

std::string describe(const PassedOver& passed_over) {
  return passed_over.topic + " is not used: " + passed_over.why;
}

std::vector<std::string> notes_of(const RecordedSensors& sensors) {
  std::vector<std::string> notes;
  for (const PassedOver& one : sensors.passed_over) {
    notes.push_back(describe(one));
  }
  const std::vector<std::string> of_transforms = notes_of(sensors.transforms);
  notes.insert(notes.end(), of_transforms.begin(), of_transforms.end());
  return notes;
}

}  // namespace adit
