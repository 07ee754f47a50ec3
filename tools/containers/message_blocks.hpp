// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The stretches of a file (its chunks) with the channels and times of their messages: what an index
// lists. They tell whether the messages of a file are grouped by topic.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// Messages that follow each other in a file: a chunk, or some outside of chunks.
struct MessageBlock {
  uint64_t offset = 0;                ///< RawMessage::offset of the first one
  TimeSpan received{};                ///< of its messages
  std::vector<std::size_t> channels;  ///< those that it has messages of
};

/// Collects the blocks of a file from its messages, in the order of the file.
class BlockCollector {
 public:
  /// `chunk`: the message is in a chunk, whose offset is `offset`.
  void add(std::size_t channel, Nanoseconds received, uint64_t offset, bool chunk);
  std::vector<MessageBlock> take() && { return std::move(blocks_); }

 private:
  std::vector<MessageBlock> blocks_;
  bool last_is_chunk_ = false;
};

/// The layout of `channels` channels, from blocks in the order of the file. A file of few blocks
/// has a layout without channels: the blocks are too coarse to tell.
MessageLayout layout_of(const std::vector<MessageBlock>& blocks, std::size_t channels);

/// The same from every message of a file.
class LayoutObserver {
 public:
  explicit LayoutObserver(std::size_t channels) : last_(channels) {
    layout_.channels.resize(channels);
  }
  void add(std::size_t channel, const TimeSpan& times, uint64_t offset);
  MessageLayout take() &&;

 private:
  MessageLayout layout_;
  std::vector<std::optional<TimeSpan>> last_;  // of the channel's last message or block
  Nanoseconds newest_ = Nanoseconds::min();    // latest begin so far
  bool steps_back_ = false;
};

/// The offsets of blocks that have none of the channels.
std::set<uint64_t> blocks_without(const std::vector<MessageBlock>& blocks,
                                  const std::vector<std::size_t>& channels);

}  // namespace adit
