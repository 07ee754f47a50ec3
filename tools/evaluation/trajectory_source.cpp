// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/trajectory_source.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "adit/tools/evaluation/pose_table.hpp"
#include "adit/tools/packets/packet_capture.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// "/tf:base_link", or "/odom" where all poses of the topic are of one frame.
std::string name_of(const std::string& topic, const std::string& frame, std::size_t frames) {
  return frames > 1 ? topic + ":" + frame : topic;
}

/// The poses of a recording, by topic and frame, in its order.
std::map<std::string, std::vector<StampedPose>> poses_of(const Recording& recording) {
  EventSelection selection;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (recording.topics()[i].kind == TopicKind::poses) {
      selection.topics.push_back(i);
    }
  }
  if (selection.topics.empty()) {
    return {};
  }
  std::map<std::pair<std::size_t, std::string>, std::vector<StampedPose>> found;
  std::map<std::size_t, std::size_t> frames;  // number of frames per topic
  const auto events = recording.events(selection);
  while (const std::optional<Event> event = events->next()) {
    if (const auto* pose = std::get_if<ReferencePose>(&event->value)) {
      std::vector<StampedPose>& series = found[{event->topic, pose->child}];
      frames[event->topic] += series.empty() ? 1U : 0U;
      series.push_back({.stamp = pose->stamp, .pose = pose->T_parent_child});
    }
  }
  std::map<std::string, std::vector<StampedPose>> named;
  for (auto& [key, poses] : found) {
    named[name_of(recording.topics()[key.first].name, key.second, frames[key.first])] =
        std::move(poses);
  }
  return named;
}

Trajectory read_recorded(const TrajectorySource& source) {
  const std::unique_ptr<Recording> recording = open_recording(source.path);
  std::map<std::string, std::vector<StampedPose>> series = poses_of(*recording);
  std::string known;
  for (const auto& [name, poses] : series) {
    known += (known.empty() ? "" : ", ") + name;
  }
  if (series.empty()) {
    throw InputError(source.path, {}, "there are no poses in it",
                     "A trajectory is read from TUM or KITTI text, a table with named columns, the "
                     "folder of a run, or a recording with poses");
  }
  if (source.topic.empty() && series.size() > 1) {
    throw InputError(source.path, {}, "it has several series of poses: " + known,
                     "Choose one with --truth-topic or --estimate-topic");
  }
  const auto chosen = source.topic.empty() ? series.begin() : series.find(source.topic);
  if (chosen == series.end()) {
    throw InputError(source.path, {}, "it has no poses named " + source.topic, "It has " + known);
  }
  Trajectory trajectory{
      .file = source.path / fs::path(chosen->first).relative_path(), .stamped = true, .poses = {}};
  trajectory.poses = std::move(chosen->second);
  std::ranges::stable_sort(trajectory.poses, {}, &StampedPose::stamp);
  return trajectory;
}

/// Whether the file is a container of messages or packets: recognised by content.
bool is_container(const fs::path& file) {
  return is_packet_capture(file) || !open_message_files(file).empty();
}

bool is_recorded(const fs::path& path) {
  std::error_code unknown;
  return fs::is_directory(path, unknown) ||
         (fs::is_regular_file(path, unknown) && is_container(path));
}

}  // namespace

SourceUse use_of(const fs::path& path) {
  std::error_code unknown;
  if (fs::is_regular_file(RunFiles(path).tum, unknown)) {
    return {};
  }
  if (is_recorded(path)) {
    return {.topic = true};
  }
  return {.times = !is_table(read_text_file(path)) && !read_trajectory(path).stamped};
}

Trajectory read_any_trajectory(const TrajectorySource& source) {
  std::error_code unknown;
  const fs::path of_run = RunFiles(source.path).tum;
  if (fs::is_regular_file(of_run, unknown) && source.topic.empty()) {
    return read_trajectory(of_run);
  }
  if (is_recorded(source.path)) {
    return read_recorded(source);
  }
  const std::string text = read_text_file(source.path);
  if (!is_table(text)) {
    return read_trajectory(source.path, source.times);
  }
  Trajectory trajectory = read_pose_table(source.path, text);
  if (trajectory.poses.empty()) {
    throw InputError(source.path, {}, "it holds no pose", "Its table has no line with numbers");
  }
  std::ranges::stable_sort(trajectory.poses, {}, &StampedPose::stamp);
  return trajectory;
}

}  // namespace adit
