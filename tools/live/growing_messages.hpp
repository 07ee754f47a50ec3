// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/live/message_recorder.hpp"

namespace adit {

/// The file that a MessageRecorder writes, as a container of messages: first what was written when
/// this was made; from wait_for_more() on, new streams wait at the end of what is written, and end
/// when the recorder has finished.
class GrowingMessages final : public MessageFile {
 public:
  /// `recorder` outlives it.
  explicit GrowingMessages(const MessageRecorder& recorder);

  void wait_for_more() { waits_ = true; }

  const std::filesystem::path& path() const override { return recorder_->path(); }
  const std::vector<Channel>& channels() const override { return recorder_->channels(); }
  std::optional<TimeSpan> span() const override { return std::nullopt; }
  std::string format() const override { return "ROS 2 topics as they arrive"; }
  const std::optional<InputError>& damage() const override { return no_damage_; }
  /// Throws InputError where the file cannot be read.
  std::unique_ptr<MessageStream> messages(const MessageSelection& selection) const override;

 private:
  const MessageRecorder* recorder_;
  uint64_t end_;
  bool waits_ = false;
  std::optional<InputError> no_damage_{};
};

}  // namespace adit
