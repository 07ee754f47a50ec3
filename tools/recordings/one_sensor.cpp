// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/one_sensor.hpp"

#include <chrono>
#include <optional>
#include <set>

#include "adit/tools/recordings/topic_survey.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kRenamed = std::chrono::seconds(1);  // of silence; sensors publish more often

}  // namespace

/// Leaves out what other sensors publish on the same topics.
class OneSensorStream final : public EventStream {
 public:
  OneSensorStream(const OneSensorRecording& recording, const EventSelection& selection)
      : recording_(&recording), events_(recording.recording_->events(selection)) {
    for (const auto& [topic, frame] : recording.frames_) {
      sensors_[topic].frame = frame;
    }
  }

  std::optional<Event> next() override {
    while (true) {
      std::optional<Event> event = events_->next();
      if (!event || is_of_sensor(*event)) {
        return event;
      }
    }
  }

 private:
  struct Sensor {
    std::string frame;
    Nanoseconds begin{0};               ///< receipt of the first message of the topic
    std::optional<Nanoseconds> last{};  ///< receipt of its last message
    std::set<std::string> others{};     ///< frames that were seen while it published
  };

  bool is_of_sensor(const Event& event) {
    const bool of_sensor = !std::holds_alternative<ReferencePose>(event.value) &&
                           !std::holds_alternative<StaticTransform>(event.value);
    const std::string frame = plain_frame(event.frame);
    if (!of_sensor || frame.empty()) {
      return true;
    }
    Sensor& sensor = sensors_[event.topic];
    if (sensor.frame.empty()) {
      sensor.frame = frame;
    }
    if (!sensor.last && sensor.others.empty()) {
      sensor.begin = event.received;
    }
    if (frame != sensor.frame) {
      const bool alive = event.received - sensor.last.value_or(sensor.begin) <= kRenamed;
      if (alive || (sensor.last && sensor.others.contains(frame))) {
        sensor.others.insert(frame);
        const std::lock_guard lock(recording_->mutex_);
        ++recording_->left_out_[{event.topic, frame}];
        return false;
      }
      sensor.others.insert(sensor.frame);
      sensor.frame = frame;
    }
    if (!sensor.last || sensor.frame != noted_[event.topic]) {
      noted_[event.topic] = sensor.frame;
      const std::lock_guard lock(recording_->mutex_);
      recording_->used_[event.topic].push_back(sensor.frame);
    }
    sensor.last = event.received;
    return true;
  }

  const OneSensorRecording* recording_;
  std::unique_ptr<EventStream> events_;
  std::map<std::size_t, Sensor> sensors_;     // by topic
  std::map<std::size_t, std::string> noted_;  // the frame that was noted last
};

OneSensorRecording::OneSensorRecording(const Recording& recording,
                                       std::map<std::size_t, std::string> frames)
    : recording_(&recording), frames_(std::move(frames)) {}

std::unique_ptr<EventStream> OneSensorRecording::events(const EventSelection& selection) const {
  return std::make_unique<OneSensorStream>(*this, selection);
}

std::vector<std::string> OneSensorRecording::notes() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> notes;
  for (const auto& [of, count] : left_out_) {
    const auto& [topic, frame] = of;
    const auto used = used_.find(topic);
    notes.push_back(std::to_string(count) + " messages of " + topics()[topic].name +
                    " from the frame '" + frame + "' are left out: they are another sensor's" +
                    (used == used_.end() ? "" : "; '" + used->second.back() + "' is used"));
  }
  for (const auto& [topic, frames] : used_) {
    for (std::size_t i = 1; i < frames.size(); ++i) {
      if (frames[i] != frames[i - 1]) {
        notes.push_back("the frame of " + topics()[topic].name + " changes from '" + frames[i - 1] +
                        "' to '" + frames[i] + "'; it is taken for the same sensor");
      }
    }
  }
  return notes;
}

}  // namespace adit
