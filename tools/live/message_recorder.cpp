// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/message_recorder.hpp"

#include <utility>

namespace adit {

MessageRecorder::MessageRecorder(std::filesystem::path path, std::vector<Channel> channels,
                                 const RecordingSplit& split)
    : parts_(std::move(path), split), channels_(std::move(channels)) {
  open();
}

void MessageRecorder::open() {
  path_ = parts_.path();
  writer_ = std::make_unique<McapWriter>(path_, McapOptions{.chunks = false, .profile = "ros2"});
  for (const Channel& channel : channels_) {
    writer_->add_channel(channel);
  }
  begin_ = writer_->flush();
  committed_ = begin_;
}

void MessageRecorder::write(std::size_t channel, Nanoseconds received,
                            std::span<const std::byte> bytes) {
  const std::scoped_lock lock(mutex_);
  if (finished_) {
    return;
  }
  if (parts_.advance(received, committed_)) {
    writer_->close();
    open();
  }
  writer_->write(channel, received, bytes);
  committed_ = writer_->flush();
  reserve_->written(committed_);
}

void MessageRecorder::finish() {
  const std::scoped_lock lock(mutex_);
  writer_->close();
  finished_ = true;
}

}  // namespace adit
