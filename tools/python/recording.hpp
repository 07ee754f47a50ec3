// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// adit.Recording: a file of any format that `adit run` reads, and its events.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "adit/slam/core/config.hpp"
#include "adit/tools/recordings/merged_sweeps.hpp"
#include "adit/tools/recordings/one_sensor.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit::python {

namespace py = pybind11;

/// The topics that a run maps, as indices.
struct SensorTopics {
  std::size_t sweeps = 0;
  std::optional<std::size_t> imu{};
  std::optional<std::size_t> gnss{};
  std::optional<std::size_t> velocity{};
  std::optional<std::size_t> heading{};

  std::vector<std::size_t> all() const;
};

/// The files of a recording, with what `adit run` finds in them.
class OpenRecording {
 public:
  /// Throws InputError.
  OpenRecording(const std::filesystem::path& path, const Config& config, bool strict);

  const std::filesystem::path& path() const { return path_; }
  const Config& config() const { return config_; }
  const std::vector<Topic>& topics() const { return recording_->topics(); }
  std::string description() const { return recording_->description(); }
  bool times_are_assumed() const { return recording_->times_are_assumed(); }

  /// As `adit run` chooses them, with its checks: throws InputError, UsageError.
  SensorTopics sensors() const;
  std::vector<StaticTransform> transforms() const;
  /// Index of a topic. Throws UsageError where there is none of that name.
  std::size_t topic_named(const std::string& name) const;

  /// Unless `strict`, damage is passed over and listed.
  std::unique_ptr<EventStream> events(const std::vector<std::size_t>& topics) const;
  /// The events of sensors(), of one frame a topic.
  std::unique_ptr<EventStream> mapped_events() const;
  std::vector<std::string> damage() const;

 private:
  std::unique_ptr<Recording> without_damage(const Recording& recording) const;

  std::filesystem::path path_;
  Config config_;
  std::unique_ptr<Recording> recording_;
  std::unique_ptr<Recording> whole_;  ///< the same without its damage; null: strict
  mutable std::mutex mutex_;
  mutable std::vector<std::string> damage_;
  mutable std::optional<SensorTopics> sensors_;
  mutable std::optional<OneSensorRecording> mapped_;   ///< with sensors_
  mutable std::optional<MergedRecording> merged_;      ///< the same, of all range sensors
  mutable std::unique_ptr<Recording> whole_merged_{};  ///< without its damage; null: strict
  mutable std::vector<StaticTransform> transforms_;    ///< with sensors_
};

/// Events that are read from a recording until it is closed.
class RecordedEvents {
 public:
  RecordedEvents(std::shared_ptr<const OpenRecording> opened, std::unique_ptr<EventStream> events)
      : path_(opened->path()), opened_(std::move(opened)), events_(std::move(events)) {}

  /// Throws ValueError once it is closed.
  void require_open();
  /// Nothing at the end. Throws what reading throws, ValueError once it is closed.
  std::optional<Event> next();
  /// Waits for a next() of another thread.
  void close();

 private:
  std::filesystem::path path_;
  std::mutex mutex_;
  std::shared_ptr<const OpenRecording> opened_;  ///< which `events_` read; null: closed
  std::unique_ptr<EventStream> events_;
};

/// The recording as Python has it, which may close it.
class RecordingFile {
 public:
  explicit RecordingFile(std::shared_ptr<const OpenRecording> opened)
      : path_(opened->path()), config_(opened->config()), opened_(std::move(opened)) {}

  const std::filesystem::path& path() const { return path_; }
  const Config& config() const { return config_; }
  /// Throws ValueError once it is closed.
  std::shared_ptr<const OpenRecording> opened() const;
  /// Those of these topics, and those that a run maps. Throw ValueError once it is closed.
  std::shared_ptr<RecordedEvents> events(const std::vector<std::size_t>& topics);
  std::shared_ptr<RecordedEvents> mapped_events();
  bool closed() const;
  /// With all that still reads it.
  void close();
  /// Also once it is closed.
  std::vector<std::string> damage() const;

 private:
  std::shared_ptr<RecordedEvents> until_closed(std::shared_ptr<const OpenRecording> opened,
                                               std::unique_ptr<EventStream> events);

  std::filesystem::path path_;
  Config config_;
  mutable std::mutex mutex_;
  std::shared_ptr<const OpenRecording> opened_;  ///< null: closed
  std::vector<std::weak_ptr<RecordedEvents>> given_;
  std::vector<std::string> damage_;  ///< of a closed one
};

void bind_recording(py::module_& module);

}  // namespace adit::python
