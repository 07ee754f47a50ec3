// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/tolerant_recording.hpp"

#include <utility>

namespace adit {
namespace {

using Told = std::function<void(const InputError&)>;

class TolerantStream final : public EventStream {
 public:
  TolerantStream(std::unique_ptr<EventStream> events, const Told& damage)
      : events_(std::move(events)), damage_(&damage) {}

  std::optional<Event> next() override {
    while (true) {
      try {
        return events_->next();
      } catch (const InputError& error) {
        (*damage_)(error);  // the call after it goes on behind, or finds the end
      }
    }
  }

 private:
  std::unique_ptr<EventStream> events_;
  const Told* damage_;
};

class TolerantRecording final : public Recording {
 public:
  TolerantRecording(const Recording& recording, Told damage)
      : recording_(&recording), damage_(std::move(damage)) {}

  const std::vector<Topic>& topics() const override { return recording_->topics(); }
  std::string description() const override { return recording_->description(); }
  bool times_are_assumed() const override { return recording_->times_are_assumed(); }
  std::vector<RecordingNotice> notices() const override { return recording_->notices(); }
  std::optional<double> recorded_wait() const override { return recording_->recorded_wait(); }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<TolerantStream>(recording_->events(selection), damage_);
  }

 private:
  const Recording* recording_;
  Told damage_;
};

}  // namespace

std::unique_ptr<Recording> pass_over_damage(const Recording& recording,
                                            std::function<void(const InputError&)> damage) {
  return std::make_unique<TolerantRecording>(recording, std::move(damage));
}

}  // namespace adit
