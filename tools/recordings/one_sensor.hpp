// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Several sensors may publish on one topic, as two lidars behind a merging relay do. Only the frame
// that their messages name tells them apart, and mixed they make no map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A recording in which each topic of sweeps, readings, fixes or velocities has one sensor.
///
/// `frames` names the frame of a topic's sensor; of other topics it is the first frame. Messages of
/// another frame are left out while the sensor's own arrive. Where another frame appears only after
/// the sensor has been silent for a second, the same sensor has been renamed, and its messages are
/// used. Messages without a frame are used.
class OneSensorRecording final : public Recording {
 public:
  /// `recording` outlives it.
  OneSensorRecording(const Recording& recording, std::map<std::size_t, std::string> frames);

  const std::vector<Topic>& topics() const override { return recording_->topics(); }
  std::string description() const override { return recording_->description(); }
  bool times_are_assumed() const override { return recording_->times_are_assumed(); }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override;

  /// What the streams have left out so far and which sensors were renamed, a sentence each.
  std::vector<std::string> notes() const;

 private:
  friend class OneSensorStream;

  const Recording* recording_;
  std::map<std::size_t, std::string> frames_;
  mutable std::mutex mutex_;  ///< streams may be read in other threads
  mutable std::map<std::pair<std::size_t, std::string>, uint64_t>
      left_out_;                                                  ///< by topic and frame
  mutable std::map<std::size_t, std::vector<std::string>> used_;  ///< frames, in order
};

}  // namespace adit
