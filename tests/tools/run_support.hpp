// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of `adit run` share.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit::test {

inline std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// How often a part occurs in a text.
inline std::size_t count(std::string_view text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

inline nlohmann::json json_of(const std::filesystem::path& file) {
  return nlohmann::json::parse(content(file));
}

inline std::size_t lines(const std::filesystem::path& file) {
  const std::string text = content(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// A recording in memory; `before_read` may throw or raise.
class MemoryRecording : public Recording {
 public:
  explicit MemoryRecording(std::size_t size, std::function<void(std::size_t)> before_read = {},
                           std::function<Nanoseconds(std::size_t)> stamp = {})
      : topics_({{.name = "/points",
                  .type = "made for a test",
                  .kind = TopicKind::sweeps,
                  .messages = size}}),
        before_read_(std::move(before_read)),
        stamp_(std::move(stamp)) {}

  const std::vector<Topic>& topics() const override { return topics_; }
  std::string description() const override { return "made for a test"; }
  bool times_are_assumed() const override { return false; }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<Stream>(*this, selection.skip);
  }

  Sweep read(std::size_t index) const {
    if (before_read_) {
      before_read_(index);
    }
    Sweep sweep;
    sweep.stamp = stamp_ ? stamp_(index) : std::chrono::milliseconds(100 * index);
    sweep.points = {{1.0F, 2.0F, 3.0F, 0.5F}, {1.01F, 2.0F, 3.0F, 0.6F}, {4.0F, 5.0F, 6.0F, 0.7F}};
    sweep.source = "sweep_" + std::to_string(index);
    return sweep;
  }

 private:
  class Stream : public EventStream {
   public:
    Stream(const MemoryRecording& recording, std::size_t first)
        : recording_(&recording), index_(first) {}
    std::optional<Event> next() override {
      if (index_ >= recording_->topics_.front().messages) {
        return std::nullopt;
      }
      Sweep sweep = recording_->read(index_++);
      return Event{.topic = 0, .received = sweep.stamp, .value = std::move(sweep)};
    }

   private:
    const MemoryRecording* recording_;
    std::size_t index_;
  };

  std::vector<Topic> topics_;
  std::function<void(std::size_t)> before_read_;
  std::function<Nanoseconds(std::size_t)> stamp_;
};

/// A result as of an odometry that moves a metre a sweep along x and makes each one a keyframe.
inline SweepResult placed(const Sweep& sweep) {
  SweepResult result;
  result.stamp = sweep.stamp;
  result.T_map_lidar.translation().x() = 10.0 * std::chrono::duration<double>(sweep.stamp).count();
  result.state = sweep.stamp.count() == 0 ? OdometryState::initializing : OdometryState::tracking;
  result.registration.status = RegistrationStatus::converged;
  result.keyframe = true;
  result.raw_points = static_cast<int>(sweep.points.size());
  result.valid_points = result.raw_points;
  result.cloud_points = result.raw_points;
  result.cloud = sweep.points;
  return result;
}

/// Where small_recording() puts things.
struct SmallRecording {
  explicit SmallRecording(const std::filesystem::path& folder)
      : recording(folder / "recording"), truth(folder / "truth.tum") {}

  std::filesystem::path recording;
  std::filesystem::path truth;
};

/// A drive along a synthetic street, 0.8 m a sweep, as a KITTI folder, seen by a lidar that makes
/// small files.
inline SmallRecording small_recording(const std::filesystem::path& folder, std::size_t sweeps) {
  SmallRecording files(folder);
  std::filesystem::create_directories(files.recording / "velodyne");
  const World world = make_street(20.0);
  std::vector<StampedPose> poses = steady_drive(sweeps, twist(0.8));
  std::string times;
  for (std::size_t i = 0; i < sweeps; ++i) {
    const Sweep sweep =
        scan(world, poses[i], {.beams = 24, .columns = 360, .max_range = 80.0}, i + 1);
    const std::string name = fmt::format("{:06}.bin", i);
    std::ofstream(files.recording / "velodyne" / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(sweep.points.data()),
               static_cast<std::streamsize>(sweep.points.size() * sizeof(Point)));
    times += std::to_string(0.1 * static_cast<double>(i)) + "\n";
  }
  std::ofstream(files.recording / "times.txt") << times;
  const Eigen::Isometry3d T_map_world = poses.front().pose.inverse();
  const Nanoseconds start = poses.front().stamp;
  for (StampedPose& pose : poses) {
    pose = {.stamp = pose.stamp - start, .pose = T_map_world * pose.pose};
  }
  write_trajectory(files.truth, TrajectoryFormat::tum, poses);
  return files;
}

}  // namespace adit::test
