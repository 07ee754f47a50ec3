// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/configured_recording.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/clouds/cloud_origin.hpp"
#include "adit/tools/recordings/ros_messages.hpp"
#include "adit/tools/recordings/velocities_of_poses.hpp"
#include "adit/tools/topics/topic_statistics.hpp"

namespace adit {
namespace {

// Times from azimuths (recording.spin_rate): the turn begins and ends at -x, half a turn before and
// after the stamp. Points that are none get the stamp's.
void add_times_of_turn(Sweep& sweep, double spin_rate) {
  const double half = 0.5 / std::abs(spin_rate);  // s
  sweep.times.reserve(sweep.points.size());
  for (const Point& point : sweep.points) {
    const double azimuth = std::atan2(point.y, point.x);
    const double turns = std::isfinite(azimuth) ? azimuth / (2.0 * std::numbers::pi) : 0.0;
    sweep.times.push_back(static_cast<float>(half + turns / spin_rate));
  }
  sweep.stamp -= nanoseconds(half);
}

// Each point turned upwards in the vertical plane that it lies in (recording.beam_elevation).
void raise_beams(Sweep& sweep, double angle) {
  const double cosine = std::cos(angle);
  const double sine = std::sin(angle);
  for (Point& point : sweep.points) {
    const double level = std::hypot(point.x, point.y);
    if (!(level > 0.0)) {
      continue;
    }
    const double stretch = (cosine * level - sine * point.z) / level;
    point.z = static_cast<float>(sine * level + cosine * point.z);
    point.x = static_cast<float>(stretch * point.x);
    point.y = static_cast<float>(stretch * point.y);
  }
}

class CorrectedStream final : public EventStream {
 public:
  CorrectedStream(std::unique_ptr<EventStream> events, const RecordingConfig& config)
      : events_(std::move(events)), config_(config) {}

  std::optional<Event> next() override {
    std::optional<Event> event = events_->next();
    if (event) {
      event->value = corrected(std::move(event->value), config_);
    }
    return event;
  }

 private:
  std::unique_ptr<EventStream> events_;
  RecordingConfig config_;
};

class ConfiguredRecording final : public Recording {
 public:
  ConfiguredRecording(std::unique_ptr<Recording> recording, const RecordingConfig& config)
      : recording_(std::move(recording)), config_(config) {}

  const std::vector<Topic>& topics() const override { return recording_->topics(); }
  std::string description() const override { return recording_->description(); }
  bool times_are_assumed() const override { return recording_->times_are_assumed(); }
  std::vector<RecordingNotice> notices() const override { return recording_->notices(); }
  std::optional<double> recorded_wait() const override { return recording_->recorded_wait(); }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    EventSelection wanted = selection;
    wanted.point_time_unit = config_.point_time_unit;
    wanted.coordinate_scale = config_.coordinate_scale;
    if (config_.floats_per_point != 0) {
      wanted.floats_per_point = static_cast<uint32_t>(config_.floats_per_point);
    }
    const bool of_poses =
        wanted.velocities_of &&
        (config_.velocity_of_poses ||
         topics()[*wanted.velocities_of].type != std::string_view(ros::Odometry::kType)) &&
        topics()[*wanted.velocities_of].kind == TopicKind::poses;
    const std::size_t poses = wanted.velocities_of.value_or(0);
    if (of_poses) {
      wanted.velocities_of.reset();
    }
    auto events = std::make_unique<CorrectedStream>(recording_->events(wanted), config_);
    return of_poses ? with_velocities_of_poses(std::move(events), poses) : std::move(events);
  }

 private:
  std::unique_ptr<Recording> recording_;
  RecordingConfig config_;
};

}  // namespace

EventValue corrected(EventValue value, const RecordingConfig& config) {
  if (auto* sweep = std::get_if<Sweep>(&value)) {
    sweep->stamp += nanoseconds(config.sweep_time_offset);
    if (config.spin_rate != 0.0 && sweep->times.empty()) {
      add_times_of_turn(*sweep, config.spin_rate);
    }
    if (config.beam_elevation != 0.0) {
      raise_beams(*sweep, config.beam_elevation);
    }
  } else if (auto* sample = std::get_if<ImuSample>(&value)) {
    sample->stamp += nanoseconds(config.imu_time_offset);
    sample->linear_acceleration *= config.accelerometer_scale;
    sample->angular_velocity *= config.gyroscope_scale;
  }
  return value;
}

std::unique_ptr<Recording> open_recording(const std::filesystem::path& path,
                                          const RecordingConfig& config) {
  return open_recording(std::vector{path}, config);
}

std::unique_ptr<Recording> open_recording(const std::vector<std::filesystem::path>& paths,
                                          const RecordingConfig& config) {
  std::unique_ptr<Recording> recording =
      open_recording(paths, std::filesystem::path(config.metadata.value_or("")));
  return configured(std::move(recording), config);
}

std::unique_ptr<Recording> configured(std::unique_ptr<Recording> recording,
                                      const RecordingConfig& config) {
  if (config == RecordingConfig{}) {
    return recording;
  }
  return std::make_unique<ConfiguredRecording>(std::move(recording), config);
}

std::size_t require_clear_point_times(const Recording& recording, std::size_t topic,
                                      const std::filesystem::path& path) {
  constexpr int kSweeps = 5;
  constexpr double kCoarsest = 0.01;  // m, what range sensors measure to
  std::size_t most_points = 0;
  TopicStatistics statistics;
  std::string place;
  const auto events = recording.events({.topics = {topic}});
  for (int i = 0; i < kSweeps; ++i) {
    std::optional<Event> event;
    try {
      event = events->next();
    } catch (const InputError&) {
      continue;  // whoever reads on reports it
    }
    if (!event) {
      break;
    }
    place = std::get<Sweep>(event->value).source;
    if (event->coordinate_step > kCoarsest) {
      throw InputError(path, Place::named(place), coarse_note(event->coordinate_step), "");
    }
    most_points = std::max(most_points, std::get<Sweep>(event->value).points.size());
    statistics.add(*event);
  }
  if (statistics.point_times_fit()) {
    return most_points;
  }
  const std::optional<double> unit = statistics.better_time_unit();
  const std::string found = fmt::format(
      "by its points' times a sweep lasts {:.6f} s (understood in units of {:g} s), but the sweeps "
      "follow each other every {:.4f} s",
      statistics.sweeps.duration.mean(), statistics.point_times->unit, statistics.period());
  const std::string remedy =
      fmt::format("Set the unit of the times: --set recording.point_time_unit={:g}{}",
                  unit.value_or(1e-9), unit ? " would fit" : ", or what it is");
  throw InputError(path, Place::named(place), found, remedy);
}

}  // namespace adit
