// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/message_blocks.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace adit {
namespace {

/// Of messages outside of chunks: as large as the chunks that recorders write.
constexpr uint64_t kBlockBytes = uint64_t{1} << 20U;
/// A file of fewer blocks may be grouped within them.
constexpr std::size_t kFewBlocks = 8;
/// The SLAM system waits so long for late measurements (slam/executor/sensor_feed).
constexpr Nanoseconds kLate = std::chrono::milliseconds(500);
constexpr std::size_t kLateBlocks = 8;  // that are noted
/// Differences of times that are not beyond this do not overflow.
constexpr Nanoseconds kFarthest = Nanoseconds::max() / 4;

void widen(TimeSpan& span, const TimeSpan& by) {
  span = {std::min(span.begin, by.begin), std::max(span.end, by.end)};
}

bool is_before(Nanoseconds a, Nanoseconds b) {
  return a < b && b - a > kLate;
}

}  // namespace

void BlockCollector::add(std::size_t channel, Nanoseconds received, uint64_t offset, bool chunk) {
  const bool same =
      !blocks_.empty() && last_is_chunk_ == chunk &&
      (chunk ? blocks_.back().offset == offset : offset - blocks_.back().offset < kBlockBytes);
  if (!same) {
    blocks_.push_back({offset, {received, received}, {}});
    last_is_chunk_ = chunk;
  }
  MessageBlock& block = blocks_.back();
  widen(block.received, {received, received});
  if (std::ranges::count(block.channels, channel) == 0) {
    block.channels.push_back(channel);
  }
}

void LayoutObserver::add(std::size_t channel, const TimeSpan& times, uint64_t offset) {
  const TimeSpan received{std::clamp(times.begin, -kFarthest, kFarthest),
                          std::clamp(times.end, -kFarthest, kFarthest)};
  ChannelLayout& layout = layout_.channels[channel];
  if (layout.received) {
    widen(*layout.received, received);
  } else {
    layout.received = received;
  }
  if (last_[channel] && received.begin - last_[channel]->end > layout.pause.length) {
    layout.pause = {received.begin - last_[channel]->end, layout.last, offset};
  }
  layout.last = offset;
  // A block is of several channels: only where the whole of it is earlier, its messages are.
  std::optional<TimeSpan>& last = last_[channel];
  steps_back_ = steps_back_ || (last && is_before(received.end, last->begin));
  last = received;
  if (is_before(received.begin, newest_) && layout_.late.size() < kLateBlocks &&
      (layout_.late.empty() || layout_.late.back().offset != offset)) {
    layout_.late.push_back({offset, newest_});
  }
  newest_ = std::max(newest_, received.begin);
}

MessageLayout LayoutObserver::take() && {
  layout_.grouped = !layout_.late.empty() && !steps_back_;
  return std::move(layout_);
}

MessageLayout layout_of(const std::vector<MessageBlock>& blocks, std::size_t channels) {
  if (blocks.size() < kFewBlocks) {
    return {};
  }
  LayoutObserver observer(channels);
  for (const MessageBlock& block : blocks) {
    for (const std::size_t channel : block.channels) {
      observer.add(channel, block.received, block.offset);
    }
  }
  return std::move(observer).take();
}

std::set<uint64_t> blocks_without(const std::vector<MessageBlock>& blocks,
                                  const std::vector<std::size_t>& channels) {
  std::set<uint64_t> without;
  for (const MessageBlock& block : blocks) {
    const bool wanted = std::ranges::any_of(block.channels, [&](std::size_t channel) {
      return std::ranges::count(channels, channel) > 0;
    });
    if (!wanted) {
      without.insert(block.offset);
    }
  }
  return without;
}

}  // namespace adit
