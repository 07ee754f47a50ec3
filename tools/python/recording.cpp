// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/recording.hpp"

#include <algorithm>
#include <utility>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "adit/tools/python/configuration.hpp"
#include "adit/tools/python/gil.hpp"
#include "adit/tools/python/measurements.hpp"
#include "adit/tools/python/pickling.hpp"
#include "adit/tools/recordings/tolerant_recording.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/setup/sensor_topics.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::python {
namespace {

py::value_error closed_error(const std::filesystem::path& path) {
  return py::value_error(path.string() + ": the recording is closed");
}

/// The events of a recording, as a Python iterator; static transforms first.
class EventIterator {
 public:
  EventIterator(std::shared_ptr<RecordedEvents> events, std::vector<Topic> topics,
                std::vector<StaticTransform> transforms)
      : events_(std::move(events)),
        topics_(std::move(topics)),
        transforms_(std::move(transforms)) {}

  py::object next() {
    const StaticTransform* transform = nullptr;
    std::optional<Event> event;
    without_gil([&] {
      const std::lock_guard lock(mutex_);
      if (given_ < transforms_.size()) {
        events_->require_open();
        transform = &transforms_[given_++];
      } else {
        event = events_->next();
      }
    });
    if (transform != nullptr) {
      return py::cast(Measured<StaticTransform>{.value = *transform});
    }
    if (!event) {
      throw py::stop_iteration();
    }
    return object_of(std::move(*event), topics_);
  }

 private:
  std::shared_ptr<RecordedEvents> events_;
  std::vector<Topic> topics_;
  std::vector<StaticTransform> transforms_;
  std::size_t given_ = 0;
  std::mutex mutex_;
};

std::unique_ptr<EventIterator> iterate(RecordingFile& recording,
                                       const std::optional<std::vector<std::string>>& names) {
  return without_gil([&] {
    const std::shared_ptr<const OpenRecording> opened = recording.opened();
    if (!names) {
      return std::make_unique<EventIterator>(recording.mapped_events(), opened->topics(),
                                             opened->transforms());
    }
    std::vector<std::size_t> topics;
    for (const std::string& name : *names) {
      topics.push_back(opened->topic_named(name));
    }
    if (topics.empty()) {
      throw py::value_error("topics: none is named");
    }
    return std::make_unique<EventIterator>(recording.events(topics), opened->topics(),
                                           std::vector<StaticTransform>{});
  });
}

/// Does not check for signals: an exception would leave the recording open.
void close(RecordingFile& recording) {
  const py::gil_scoped_release released;
  recording.close();
}

}  // namespace

std::vector<std::size_t> SensorTopics::all() const {
  std::vector<std::size_t> topics{sweeps};
  for (const std::optional<std::size_t>& other : {imu, gnss, velocity, heading}) {
    if (other && std::ranges::find(topics, *other) == topics.end()) {
      topics.push_back(*other);
    }
  }
  return topics;
}

OpenRecording::OpenRecording(const std::filesystem::path& path, const Config& config, bool strict)
    : path_(path), config_(config), recording_(open_recording(path, config.recording)) {
  if (!strict) {
    whole_ = without_damage(*recording_);
  }
}

std::unique_ptr<Recording> OpenRecording::without_damage(const Recording& recording) const {
  return pass_over_damage(recording, [this](const InputError& error) {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(damage_, error.what()) == damage_.end()) {
      damage_.emplace_back(error.what());
    }
  });
}

SensorTopics OpenRecording::sensors() const {
  const std::lock_guard lock(mutex_);
  if (!sensors_) {
    const std::size_t sweeps = sweep_topic(*recording_, path_, config_.recording.sweep_topic);
    RecordedSensors chosen = choose_sensors(*recording_, sweeps, config_);
    const SensorTopics sensors{.sweeps = sweeps,
                               .imu = chosen.imu,
                               .gnss = chosen.gnss,
                               .velocity = chosen.velocity,
                               .heading = chosen.heading};
    transforms_ = std::move(chosen.transforms.transforms);
    mapped_.emplace(whole_ ? *whole_ : *recording_, chosen.frames);
    merged_.emplace(*mapped_, chosen.sweeps, path_);
    whole_merged_ = whole_ ? without_damage(*merged_) : nullptr;
    static_cast<void>(require_clear_point_times(OneSensorRecording(*recording_, chosen.frames),
                                                sensors.sweeps, path_));
    sensors_ = sensors;
  }
  return *sensors_;
}

std::vector<StaticTransform> OpenRecording::transforms() const {
  static_cast<void>(sensors());  // which looks them up
  const std::lock_guard lock(mutex_);
  return transforms_;
}

std::size_t OpenRecording::topic_named(const std::string& name) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < topics().size(); ++i) {
    if (topics()[i].name == name) {
      return i;
    }
    names.push_back(topics()[i].name);
  }
  throw UsageError("there is no topic '" + name + "'. " + suggestion(name, names) + ".");
}

std::unique_ptr<EventStream> OpenRecording::events(const std::vector<std::size_t>& topics) const {
  return (whole_ ? *whole_ : *recording_).events({.topics = topics});
}

std::unique_ptr<EventStream> OpenRecording::mapped_events() const {
  const SensorTopics chosen = sensors();
  const Recording& mapped = whole_merged_ ? *whole_merged_ : *merged_;
  return mapped.events(
      {.topics = chosen.all(), .velocities_of = chosen.velocity, .headings_of = chosen.heading});
}

std::vector<std::string> OpenRecording::damage() const {
  const std::lock_guard lock(mutex_);
  return damage_;
}

void RecordedEvents::require_open() {
  const std::lock_guard lock(mutex_);
  if (!opened_) {
    throw closed_error(path_);
  }
}

std::optional<Event> RecordedEvents::next() {
  const std::lock_guard lock(mutex_);
  if (!opened_) {
    throw closed_error(path_);
  }
  return events_->next();
}

void RecordedEvents::close() {
  const std::lock_guard lock(mutex_);
  events_.reset();
  opened_.reset();
}

std::shared_ptr<const OpenRecording> RecordingFile::opened() const {
  const std::lock_guard lock(mutex_);
  if (!opened_) {
    throw closed_error(path_);
  }
  return opened_;
}

std::shared_ptr<RecordedEvents> RecordingFile::until_closed(
    std::shared_ptr<const OpenRecording> opened, std::unique_ptr<EventStream> events) {
  const auto given = std::make_shared<RecordedEvents>(std::move(opened), std::move(events));
  const std::lock_guard lock(mutex_);
  if (!opened_) {
    throw closed_error(path_);
  }
  std::erase_if(given_, [](const auto& one) { return one.expired(); });
  given_.push_back(given);
  return given;
}

std::shared_ptr<RecordedEvents> RecordingFile::events(const std::vector<std::size_t>& topics) {
  const auto opened = this->opened();
  return until_closed(opened, opened->events(topics));
}

std::shared_ptr<RecordedEvents> RecordingFile::mapped_events() {
  const auto opened = this->opened();
  return until_closed(opened, opened->mapped_events());
}

bool RecordingFile::closed() const {
  const std::lock_guard lock(mutex_);
  return opened_ == nullptr;
}

void RecordingFile::close() {
  const std::lock_guard lock(mutex_);
  if (!opened_) {
    return;
  }
  for (const std::weak_ptr<RecordedEvents>& one : given_) {
    if (const auto events = one.lock()) {
      events->close();
    }
  }
  damage_ = opened_->damage();
  opened_.reset();
}

std::vector<std::string> RecordingFile::damage() const {
  const std::lock_guard lock(mutex_);
  return opened_ ? opened_->damage() : damage_;
}

void bind_recording(py::module_& module) {
  py::class_<Topic>(module, "Topic", "A named series of events of one kind.")
      .def_readonly("name", &Topic::name, "For folders, what the folder holds.")
      .def_readonly("type", &Topic::type, "Of its messages or files.")
      .def_property_readonly(
          "kind", [](const Topic& self) { return std::string(to_string(self.kind)); },
          "sweeps, imu, gnss, velocities, poses, transforms or other.")
      .def_readonly("messages", &Topic::messages, "How many there are; None: it is not told.")
      .def(pickling<Topic>())
      .def("__repr__", [](const Topic& self) {
        return "<adit.Topic " + self.name + ": " + std::string(to_string(self.kind)) + ">";
      });
  py::class_<EventIterator>(module, "EventIterator",
                            "Events of a recording in the order in which they were recorded.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &EventIterator::next);
  py::class_<RecordingFile, std::shared_ptr<RecordingFile>>(
      module, "Recording",
      "A recording of any format that `adit run` reads. Iterating gives what a run maps: static\n"
      "transforms, then sweeps, IMU samples and GNSS fixes as they were recorded.")
      .def_property_readonly(
          "path", [](const RecordingFile& self) { return self.path(); }, "What was opened.")
      .def_property_readonly(
          "config", [](const RecordingFile& self) { return self.config(); },
          "The configuration that it was opened with.")
      .def_property_readonly(
          "topics", [](const RecordingFile& self) { return self.opened()->topics(); },
          "All of its topics.")
      .def_property_readonly(
          "description", [](const RecordingFile& self) { return self.opened()->description(); },
          "One line: what was recognised, and how much it is.")
      .def_property_readonly(
          "times_are_assumed",
          [](const RecordingFile& self) { return self.opened()->times_are_assumed(); },
          "True where nothing tells the times and 10 Hz was assumed.")
      .def_property_readonly(
          "has_imu",
          [](const RecordingFile& self) {
            return without_gil([&] { return self.opened()->sensors().imu.has_value(); });
          },
          "True where it has an IMU that imu.use does not leave out.")
      .def_property_readonly(
          "has_gnss",
          [](const RecordingFile& self) {
            return without_gil([&] { return self.opened()->sensors().gnss.has_value(); });
          },
          "True where it has GNSS fixes that gnss.use does not leave out.")
      .def_property_readonly(
          "damage",
          [](const RecordingFile& self) { return without_gil([&] { return self.damage(); }); },
          "What was passed over so far because it is damaged, a sentence each.")
      .def(
          "events", &iterate, py::arg("topics") = py::none(),
          "The events of these topics, by name; None: those that `adit run` maps. Where the\n"
          "recording was opened with strict=True, a damaged place raises InputError, and the next\n"
          "step of the iterator goes on behind it. UsageError: no such topic.")
      .def("__iter__", [](RecordingFile& self) { return iterate(self, std::nullopt); })
      .def("close", &close,
           "Closes its files; `with adit.open(...) as recording` does at the end of the\n"
           "block. What reads it then, iterators too, raises ValueError; path, config and\n"
           "damage stay.")
      .def_property_readonly("closed", &RecordingFile::closed, "True once it is closed.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](RecordingFile& self, const py::args&) { close(self); })
      .def("__repr__", [](const RecordingFile& self) {
        return "<adit.Recording " +
               (self.closed() ? "closed: " + self.path().string() : self.opened()->description()) +
               ">";
      });
  module.def(
      "open",
      [](const std::filesystem::path& path, const py::object& config, bool strict) {
        const Config wanted = config_of(config);
        return without_gil([&] {
          return std::make_shared<RecordingFile>(
              std::make_shared<OpenRecording>(path, wanted, strict));
        });
      },
      py::arg("path"), py::arg("config") = py::none(), py::kw_only(), py::arg("strict") = false,
      "Opens an MCAP file, a ROS 1 bag, a rosbag2 folder, a capture of packets, or a folder or "
      "file\n"
      "of sweeps. config: as Config() takes it; its section \"recording\" corrects what the\n"
      "recording tells wrong. strict: raise at damage instead of passing over it. InputError.\n"
      "`with adit.open(path) as recording:` closes it at the end of the block.");
}

}  // namespace adit::python
