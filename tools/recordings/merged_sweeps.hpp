// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/core/sweep_merger.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A topic of sweeps, and the sensor that they are of.
struct MergedTopic {
  std::size_t topic = 0;
  std::string frame{};  ///< the sensor's; empty: none is named
  MergedSensor sensor{};
};

/// A recording in which the sweeps of several sensors are one series, on the topic of the first:
/// what SweepMerger makes of them. Its messages are counted by merged sweep, and how many there are
/// is not known. With one topic the recording is as it is.
class MergedRecording final : public Recording {
 public:
  /// `recording` outlives it; `path` is for messages to people. At least one topic.
  MergedRecording(const Recording& recording, std::vector<MergedTopic> sweeps,
                  std::filesystem::path path);

  const std::vector<Topic>& topics() const override { return topics_; }
  std::string description() const override { return recording_->description(); }
  bool times_are_assumed() const override { return recording_->times_are_assumed(); }
  std::vector<RecordingNotice> notices() const override { return recording_->notices(); }
  std::optional<double> recorded_wait() const override { return recording_->recorded_wait(); }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override;

  /// What became of each sensor's sweeps in the stream that ended last, a sentence each; none with
  /// one topic.
  std::vector<std::string> notes() const;
  /// The same as numbers, by topic.
  std::vector<std::pair<std::string, MergedCount>> counts() const;

 private:
  friend class MergedStream;

  const Recording* recording_;
  std::vector<MergedTopic> sweeps_;
  std::filesystem::path path_;
  std::vector<Topic> topics_;
  mutable std::mutex mutex_;  ///< streams may be read in other threads
  mutable std::vector<MergedCount> counts_;
};

}  // namespace adit
