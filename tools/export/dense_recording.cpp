// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/dense_recording.hpp"

#include <algorithm>
#include <optional>

#include <fmt/core.h>

#include "adit/tools/recordings/merged_sweeps.hpp"
#include "adit/tools/recordings/one_sensor.hpp"
#include "adit/tools/recordings/tolerant_recording.hpp"
#include "adit/tools/recordings/topic_survey.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/run/run_options.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/setup/sensor_topics.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// What a session's provenance tells under a name.
std::optional<std::string> provenance(const MapSession& session, const std::string& name) {
  for (const auto& [key, value] : session.provenance) {
    if (key == name) {
      return value;
    }
  }
  return std::nullopt;
}

MapSession only_session(const ExportJob& job) {
  const std::vector<MapSession> sessions = job.map->sessions();
  if (sessions.size() != 1) {
    throw InputError(job.options->map, {},
                     "it holds " + std::to_string(sessions.size()) + " sessions",
                     "Dense clouds and colours are of a map of one recording: adit split");
  }
  return sessions.front();
}

std::vector<MapSweep> sweeps_by_stamp(const MapDatabase& map) {
  std::vector<MapSweep> sweeps = map_path(map, {}).sweeps;
  std::ranges::stable_sort(sweeps, {}, &MapSweep::stamp);
  return sweeps;
}

SensorPath path_of(const std::vector<MapSweep>& sweeps) {
  std::vector<StampedPose> poses;
  poses.reserve(sweeps.size());
  for (const MapSweep& sweep : sweeps) {
    poses.push_back({.stamp = sweep.stamp, .pose = sweep.T_map_lidar});
  }
  return SensorPath(std::move(poses));
}

std::string frame_of(const RecordedSensors& sensors, std::optional<std::size_t> topic) {
  const auto found = topic ? sensors.frames.find(*topic) : sensors.frames.end();
  return found == sensors.frames.end() ? std::string() : found->second;
}

/// T_lidar_imu by the settings, else by the transforms.
std::optional<Eigen::Isometry3d> imu_mounting(const Config& settings, const FrameTree& tree,
                                              const std::string& lidar, const std::string& imu) {
  if (settings.imu.T_imu_lidar) {
    return pose_of(*settings.imu.T_imu_lidar).inverse();
  }
  return tree.transform(lidar, imu);
}

[[noreturn]] void fail_mounting(const fs::path& recording, const CameraSource& camera,
                                const std::string& lidar) {
  if (camera.T_imu_camera) {
    throw InputError(recording, {},
                     "the camera " + camera.name + " is mounted on the IMU, whose place is unknown",
                     "Set imu.T_imu_lidar and map again, or give T_lidar_camera: --calibration");
  }
  if (camera.frame.empty()) {
    throw InputError(recording, {}, "nothing says where the camera " + camera.name + " is mounted",
                     "Give T_lidar_camera in a file: --calibration");
  }
  throw InputError(recording, {},
                   fmt::format("no transforms lead from '{}' to '{}', the frame of the camera {}",
                               lidar, camera.frame, camera.name),
                   "Give T_lidar_camera in a file: --calibration");
}

}  // namespace

DenseRecording::DenseRecording(const ExportJob& job)
    : job_(&job), sweeps_(sweeps_by_stamp(*job.map)), path_(path_of(sweeps_)) {
  const ExportCommandOptions& options = *job.options;
  const MapSession session = only_session(job);
  settings_ = parse_config(session.configuration, options.map);
  settings_.gnss.use = false;  // sweeps alone are looked for, and where cameras are mounted
  settings_.velocity.use = false;
  paths_ = recordings_of(session);
  if (options.recording || paths_.empty()) {
    paths_ = {options.recording.value_or(fs::path())};
  }
  for (const fs::path& one : paths_) {
    keep_input("-o", *options.output, one);
  }
  recording_ = open_recording(paths_, settings_.recording);
  same_ = is_recording_of(session, paths_);
  if (!same_ && !options.recording) {
    throw InputError(paths_.front(), {},
                     "it is not what the map was made of any more, by its content",
                     "Name the recording that it was made of: --recording REC");
  }
  const std::optional<std::string> named = provenance(session, "topic");
  topic_ =
      sweep_topic(*recording_, paths_.front(), named ? named : settings_.recording.sweep_topic);
}

std::vector<CameraSource> DenseRecording::cameras() const {
  const ExportCommandOptions& options = *job_->options;
  std::vector<CameraSource> cameras = find_cameras(
      paths_, {.topics = options.cameras, .calibration = options.calibration.value_or(fs::path())});
  const auto whole = pass_over_damage(*recording_, [](const InputError&) {});
  const RecordedSensors sensors = choose_sensors(*whole, topic_, settings_);
  const std::string lidar = frame_of(sensors, topic_);
  const std::string imu = frame_of(sensors, sensors.imu);
  std::vector<std::string> frames = {lidar, imu};
  for (const CameraSource& camera : cameras) {
    frames.push_back(camera.frame);
  }
  std::erase(frames, "");
  const FrameTree tree = frame_tree_of(recorded_transforms(*whole, frames));
  for (CameraSource& camera : cameras) {
    if (!camera.T_lidar_camera && camera.T_imu_camera) {
      if (const auto T_lidar_imu = imu_mounting(settings_, tree, lidar, imu)) {
        camera.T_lidar_camera = *T_lidar_imu * *camera.T_imu_camera;
      }
    }
    if (!camera.T_lidar_camera && !camera.frame.empty()) {
      camera.T_lidar_camera = tree.transform(lidar, camera.frame);
    }
    if (!camera.T_lidar_camera) {
      fail_mounting(paths_.front(), camera, lidar);
    }
  }
  return cameras;
}

std::string DenseRecording::visit(const TakeSweep& take) const {
  Config settings = settings_;
  settings.imu.use = false;
  std::size_t placed = 0;
  std::size_t without_pose = 0;
  std::size_t damaged = 0;
  const auto whole = pass_over_damage(*recording_, [&](const InputError&) { ++damaged; });
  const RecordedSensors sensors = choose_sensors(*whole, topic_, settings);
  const OneSensorRecording mapped(*whole, sensors.frames);
  const MergedRecording merged(mapped, sensors.sweeps, paths_.front());
  const auto whole_merged = pass_over_damage(merged, [&](const InputError&) { ++damaged; });
  const auto stream = whole_merged->events({.topics = {topic_}});
  while (const std::optional<Event> event = stream->next()) {
    const auto& sweep = std::get<Sweep>(event->value);
    const auto stretch = path_.from(sweep.stamp);
    if (!stretch) {
      ++without_pose;
      continue;
    }
    take(sweep, *stretch, *std::ranges::lower_bound(sweeps_, sweep.stamp, {}, &MapSweep::stamp));
    ++placed;
  }
  if (placed == 0) {
    throw InputError(paths_.front(), {}, "none of its sweeps is in the map",
                     "Name the recording that the map is of: --recording REC");
  }
  std::string text = fmt::format("{} sweeps", placed);
  if (!same_) {
    text += " of another file than the map was made of";
  }
  if (without_pose > 0) {
    text += fmt::format("; {} sweeps have no pose in the map", without_pose);
  }
  if (damaged > 0) {
    text += fmt::format("; {} places of the recording are damaged", damaged);
  }
  return text;
}

}  // namespace adit
