// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adit/tools/live/packet_recorder.hpp"
#include "adit/tools/recordings/packet_decoder.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The capture that a PacketRecorder writes, as a recording that grows. Its events are those that
/// open_packet_capture() gives of the finished file: a stream waits at the end of what is written,
/// and ends when the recorder has finished.
class GrowingCapture final : public Recording {
 public:
  /// `topics` are those of the capture as far as it is known. `recorder` outlives it.
  GrowingCapture(const PacketRecorder& recorder, PacketSensor sensor, std::vector<Topic> topics);

  const std::vector<Topic>& topics() const override { return topics_; }
  /// Throws InputError where the file cannot be read.
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override;
  std::string description() const override;
  bool times_are_assumed() const override { return false; }

 private:
  const PacketRecorder* recorder_;
  PacketSensor sensor_;
  std::vector<Topic> topics_;
};

}  // namespace adit
