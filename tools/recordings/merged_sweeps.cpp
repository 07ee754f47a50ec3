// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/merged_sweeps.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/core.h>

#include "adit/tools/recordings/steady_stamps.hpp"

namespace adit {
namespace {

std::vector<MergedSensor> sensors_of(const std::vector<MergedTopic>& sweeps) {
  std::vector<MergedSensor> sensors;
  for (const MergedTopic& one : sweeps) {
    sensors.push_back(one.sensor);
  }
  return sensors;
}

}  // namespace

/// Sweeps of the merged topics, once they are whole; other events as they come.
class MergedStream final : public EventStream {
 public:
  MergedStream(const MergedRecording& recording, EventSelection selection)
      : recording_(&recording), merger_(sensors_of(recording.sweeps_)), skip_(selection.skip) {
    selection.skip = 0;
    for (std::size_t i = 1; i < recording.sweeps_.size() && !selection.topics.empty(); ++i) {
      selection.topics.push_back(recording.sweeps_[i].topic);
    }
    events_ = with_steady_stamps(recording.recording_->events(selection), recording.topics_,
                                 recording.path_);
  }

  ~MergedStream() override {
    const std::lock_guard lock(recording_->mutex_);
    recording_->counts_ = merger_.counts();
  }
  MergedStream(const MergedStream&) = delete;
  MergedStream& operator=(const MergedStream&) = delete;

  std::optional<Event> next() override {
    while (true) {
      if (std::optional<Sweep> sweep = merger_.next()) {
        if (Event event = event_of(std::move(*sweep)); event.number >= skip_) {
          return event;
        }
        continue;
      }
      if (ended_) {
        return std::nullopt;
      }
      std::optional<Event> event = events_->next();
      if (!event) {
        ended_ = true;
        merger_.flush();
      } else if (const auto sensor = sensor_of(*event)) {
        Sweep sweep = std::move(std::get<Sweep>(event->value));
        latest_ = std::move(*event);
        merger_.add(*sensor, std::move(sweep));
      } else {
        return event;
      }
    }
  }

 private:
  std::optional<std::size_t> sensor_of(const Event& event) const {
    const auto found = std::ranges::find(recording_->sweeps_, event.topic, &MergedTopic::topic);
    return std::holds_alternative<Sweep>(event.value) && found != recording_->sweeps_.end()
               ? std::optional(static_cast<std::size_t>(found - recording_->sweeps_.begin()))
               : std::nullopt;
  }

  /// Received with the sweep that made it whole.
  Event event_of(Sweep sweep) {
    Event event = latest_;
    event.topic = recording_->sweeps_.front().topic;
    event.number = merged_++;
    event.frame = recording_->sweeps_.front().frame;
    event.value = std::move(sweep);
    return event;
  }

  const MergedRecording* recording_;
  std::unique_ptr<EventStream> events_;
  SweepMerger merger_;
  uint64_t skip_;
  Event latest_{};
  std::size_t merged_ = 0;
  bool ended_ = false;
};

MergedRecording::MergedRecording(const Recording& recording, std::vector<MergedTopic> sweeps,
                                 std::filesystem::path path)
    : recording_(&recording),
      sweeps_(std::move(sweeps)),
      path_(std::move(path)),
      topics_(recording.topics()) {
  if (sweeps_.size() > 1) {
    topics_[sweeps_.front().topic].messages.reset();
  }
}

std::unique_ptr<EventStream> MergedRecording::events(const EventSelection& selection) const {
  const bool wanted =
      selection.topics.empty() || std::ranges::count(selection.topics, sweeps_.front().topic) > 0;
  if (sweeps_.size() < 2 || !wanted) {
    return recording_->events(selection);
  }
  return std::make_unique<MergedStream>(*this, selection);
}

std::vector<std::pair<std::string, MergedCount>> MergedRecording::counts() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::string, MergedCount>> counts;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    counts.emplace_back(topics_[sweeps_[i].topic].name, counts_[i]);
  }
  return counts;
}

std::vector<std::string> MergedRecording::notes() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const MergedCount& count = counts_[i];
    std::string text =
        fmt::format("{}: {} sweeps, {} points in {} merged sweeps", topics_[sweeps_[i].topic].name,
                    count.sweeps, count.points, count.merged);
    if (count.late_points > 0) {
      text += fmt::format("; {} points came too late", count.late_points);
    }
    notes.push_back(text);
  }
  return notes;
}

}  // namespace adit
