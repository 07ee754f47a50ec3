// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/slam_session.hpp"

#include <stdexcept>
#include <system_error>
#include <utility>
#include <variant>

#include "adit/tools/python/gil.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/setup/config_file.hpp"

namespace adit::python {
namespace {

namespace fs = std::filesystem;

MapSession session_of(const SessionOptions& options, const Config& config,
                      const engine::DeviceInfo& device) {
  MapSession session{
      .name = options.name, .configuration = to_toml(config), .provenance = provenance_of(device)};
  if (options.recording) {
    session.provenance.emplace_back("recording", fs::absolute(*options.recording).string());
  }
  return session;
}

}  // namespace

SlamSession::SlamSession(SharedDevice device, const Config& config, const SessionOptions& options)
    : device_(std::move(device)) {
  SlamOptions wanted{.inertial = options.inertial,
                     .high_rate_smoothing = options.high_rate_smoothing,
                     .map_beside = false};  // who stops after a sweep has a map of what was seen
  if (options.map) {
    std::error_code unknown;
    if (fs::exists(fs::symlink_status(*options.map, unknown))) {
      throw OutputError(*options.map, options.map->string() +
                                          ": exists. A map is written into a new file; move this "
                                          "one away, or name another.");
    }
    map_ = std::make_unique<MapDatabase>(*options.map, MapAccess::write);
    session_ = map_->add_session(session_of(options, config, device_->context().device()));
    map_->begin_run(session_);
    wanted.map = map_.get();
    wanted.session = session_;
  }
  slam_ = make_slam(device_->context(), config, wanted);
}

void SlamSession::require_open() const {
  if (finished_) {
    throw std::invalid_argument("finish_map() has ended this Slam; make another one");
  }
}

void SlamSession::add(Measurement measurement, std::string_view frame) {
  const std::lock_guard lock(mutex_);
  require_open();
  slam_->add(std::move(measurement), frame);
}

void SlamSession::add(const StaticTransform& transform) {
  const std::lock_guard lock(mutex_);
  require_open();
  slam_->add(transform);
}

void SlamSession::flush() {
  const std::lock_guard lock(mutex_);
  require_open();
  slam_->flush();
}

std::optional<SlamResult> SlamSession::next() {
  const std::lock_guard lock(mutex_);
  if (finished_) {
    return std::nullopt;
  }
  std::optional<SlamResult> result = slam_->next();
  if (result) {
    if (const auto* placed = std::get_if<SweepPlaced>(&*result)) {
      assessor_.add(placed->result);
    }
  }
  return result;
}

std::optional<Mounting> SlamSession::mounting() {
  const std::lock_guard lock(mutex_);
  return finished_ ? mounting_ : slam_->mounting();
}

Config SlamSession::config() {
  const std::lock_guard lock(mutex_);
  return finished_ ? config_ : slam_->config();
}

Verdict SlamSession::verdict() {
  const std::lock_guard lock(mutex_);
  return assessor_.verdict();
}

std::optional<MapReport> SlamSession::finish_map() {
  const std::lock_guard lock(mutex_);
  require_open();
  if (!map_) {
    return std::nullopt;
  }
  std::optional<MapReport> report = slam_->finish_map();
  if (report) {  // else the map failed, which next() has said
    map_->set_complete(session_);
  }
  finished_ = true;
  mounting_ = slam_->mounting();
  config_ = slam_->config();
  slam_.reset();
  map_.reset();  // its end leaves one file
  return report;
}

PlacedSweeps::PlacedSweeps(std::shared_ptr<SlamSession> slam, RecordingFile& recording)
    : slam_(std::move(slam)),
      events_(recording.mapped_events()),
      imu_(recording.opened()->sensors().imu) {
  for (const StaticTransform& transform : recording.opened()->transforms()) {
    slam_->add(transform);
  }
}

std::optional<SweepPlaced> PlacedSweeps::next() {
  const std::lock_guard lock(mutex_);
  for (const Checkpoint checkpoint = signal_checks();; checkpoint()) {
    while (std::optional<SlamResult> result = slam_->next()) {
      if (auto* placed = std::get_if<SweepPlaced>(&*result)) {
        return std::move(*placed);
      }
    }
    if (ended_) {
      return std::nullopt;
    }
    std::optional<Event> event = events_->next();
    if (!event) {
      ended_ = true;
      slam_->flush();
    } else if (auto* sweep = std::get_if<Sweep>(&event->value)) {
      sweep->number = event->number;
      slam_->add(std::move(*sweep), event->frame);
    } else if (const auto* reading = std::get_if<ImuSample>(&event->value)) {
      if (imu_ == event->topic) {  // else it came along with a heading
        slam_->add(*reading, event->frame);
      }
    } else if (const auto* fix = std::get_if<GnssFix>(&event->value)) {
      slam_->add(*fix, event->frame);
    } else if (const auto* velocity = std::get_if<BodyVelocity>(&event->value)) {
      slam_->add(*velocity, event->frame);
    } else if (const auto* heading = std::get_if<Heading>(&event->value)) {
      slam_->add(*heading, event->frame);
    }
  }
}

}  // namespace adit::python
