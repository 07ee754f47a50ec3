// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "adit/tools/containers/live_metadata.hpp"
#include "adit/tools/containers/message_blocks.hpp"
#include "adit/tools/recordings/message_times.hpp"
#include "adit/tools/recordings/recording_parts.hpp"

namespace adit {
namespace {

/// The SLAM system waits so long for late measurements (slam/executor/sensor_feed).
constexpr Nanoseconds kLate = std::chrono::milliseconds(500);

/// While one topic has no message, the stamps of another one go on by so much more than those of
/// the first: neither a pause of the sensor nor the periods of both make that.
constexpr Nanoseconds kStandstill = std::chrono::seconds(1);

/// A topic whose next file begins so much earlier than its last one ends had its clock set back.
constexpr Nanoseconds kStep = std::chrono::seconds(1);

/// Topics of measurements, which are put together by their times.
bool is_measured(const Topic& topic) {
  return topic.kind == TopicKind::sweeps || topic.kind == TopicKind::imu ||
         topic.kind == TopicKind::gnss || topic.kind == TopicKind::velocities ||
         topic.kind == TopicKind::headings;
}

bool is_before(Nanoseconds a, Nanoseconds b, Nanoseconds by) {
  return a < b && b - a > by;
}

/// Recorded as the messages arrived: nothing was regrouped.
bool in_order_of_arrival(const RecordingPart& part) {
  return std::ranges::all_of(part.file->channels(), [](const Channel& channel) {
    const auto order = channel.metadata.find(kOrderKey);
    return order != channel.metadata.end() && order->second == kArrivalOrder;
  });
}

Nanoseconds length(const TimeSpan& span) {
  return span.end - span.begin;
}

/// Topics of sensors that measure all the time.
bool is_steady(const Topic& topic) {
  return topic.kind == TopicKind::sweeps || topic.kind == TopicKind::imu;
}

/// The first stamp of a channel from a byte of the file on, or the last of those that `until` does
/// not end.
std::optional<Nanoseconds> find_stamp(
    const RecordingPart& part, MessageSelection selection, bool last,
    const std::function<bool(const RawMessage&)>& until = [](const RawMessage&) { return false; }) {
  std::optional<Nanoseconds> stamp;
  selection.by_index = true;
  const auto stream = part.file->messages(selection);
  for (bool more = true; more;) {
    try {
      const std::optional<RawMessage> message = stream->next();
      more = message && !until(*message);
      if (more) {
        const auto one = stamp_in(part.file->channels()[message->channel], *message);
        stamp = one ? one : stamp;
        more = last || !stamp;
      }
    } catch (const InputError&) {
      // reported where the events are read
    }
  }
  return stamp;
}

/// How much farther a topic went while another one had no messages than the other one's stamps went
/// from before to after that; 0 where these go back.
Nanoseconds standstill(const TimeSpan& pausing, Nanoseconds progress) {
  return pausing.end < pausing.begin ? Nanoseconds(0) : progress - length(pausing);
}

/// Notices in all of a part's messages, in the order of the file, where a topic stands still.
class StandstillObserver {
 public:
  explicit StandstillObserver(std::size_t channels)
      : stamps_(channels), progress_(channels), before_(channels) {}

  void add(std::size_t channel, Nanoseconds stamp) {
    if (const std::optional<Nanoseconds>& last = stamps_[channel]) {
      for (std::size_t other = 0; other < stamps_.size(); ++other) {
        found_ = found_ || (other != channel &&
                            standstill({*last, stamp}, progress_[other] - before_[channel][other]) >
                                kStandstill);
      }
      // A leap of the clock is no progress.
      const Nanoseconds step = stamp - *last;
      progress_[channel] += step > Nanoseconds(0) && step < kLate ? step : Nanoseconds(0);
    }
    stamps_[channel] = stamp;
    before_[channel] = progress_;
  }
  bool found() const { return found_; }

 private:
  std::vector<std::optional<Nanoseconds>> stamps_;  // the last one, by channel
  std::vector<Nanoseconds> progress_;               // sum of the steps, by channel
  std::vector<std::vector<Nanoseconds>> before_;    // progress_ when the channel had its last one
  bool found_ = false;
};

struct PartLayout {
  MessageLayout layout;
  bool stands_still = false;  // by their stamps topics are grouped
};

/// From all messages of the part.
PartLayout observed_layout(const RecordingPart& part, const std::vector<Topic>& topics) {
  const std::vector<Channel>& channels = part.file->channels();
  LayoutObserver observer(channels.size());
  StandstillObserver standstills(channels.size());
  const auto stream = part.file->messages({});
  for (bool more = true; more;) {
    try {
      const std::optional<RawMessage> message = stream->next();
      more = message.has_value();
      if (message) {
        const std::size_t channel = message->channel;
        observer.add(channel, {message->received, message->received}, message->offset);
        if (is_steady(topics[part.topics[channel]])) {
          if (const auto stamp = stamp_in(channels[channel], *message)) {
            standstills.add(channel, *stamp);
          }
        }
      }
    } catch (const InputError&) {
      // reported where the events are read
    }
  }
  return {std::move(observer).take(), standstills.found()};
}

/// Whether the channel stands still, by the stamps, in its longest pause.
bool stands_still(const RecordingPart& part, const std::vector<Topic>& topics,
                  const MessageLayout& layout, std::size_t channel) {
  const ChannelPause& pause = layout.channels[channel].pause;
  const auto begin = find_stamp(part, {.channels = {channel}, .from = pause.before}, true,
                                [&](const RawMessage& one) { return one.offset >= pause.after; });
  const auto end = find_stamp(part, {.channels = {channel}, .from = pause.after}, false);
  if (!begin || !end) {
    return false;
  }
  for (std::size_t other = 0; other < layout.channels.size(); ++other) {
    if (part.topics[other] == part.topics[channel] || !is_steady(topics[part.topics[other]]) ||
        !layout.channels[other].received) {
      continue;
    }
    auto from = find_stamp(part, {.channels = {other}, .from = pause.before}, true,
                           [&](const RawMessage& one) { return one.offset > pause.before; });
    from = from ? from : find_stamp(part, {.channels = {other}, .from = pause.before}, false);
    // What lies between in the file: the other one may pause itself right after it.
    const auto to = find_stamp(part, {.channels = {other}, .from = pause.before}, true,
                               [&](const RawMessage& one) { return one.offset >= pause.after; });
    // What an index says is as coarse as its chunks: only where the channel did hardly anything
    // else than stand still it did so.
    const Nanoseconds progress = from && to ? *to - *from : Nanoseconds(0);
    const Nanoseconds still = standstill({*begin, *end}, progress);
    if (still > kStandstill && 2 * still > progress) {
      return true;
    }
  }
  return false;
}

/// Whether messages of measurements in the blocks that are late by the index are so, while each
/// channel is in the order of receipt.
bool is_grouped(const RecordingPart& part, const std::vector<Topic>& topics,
                const MessageLayout& layout) {
  bool late = false;
  for (const LateBlock& block : layout.late) {
    std::vector<std::optional<Nanoseconds>> last(part.topics.size());
    const auto stream = part.file->messages({.from = block.offset});
    for (bool more = true; more;) {
      try {
        const std::optional<RawMessage> message = stream->next();
        more = message && message->offset <= block.offset;
        if (more) {
          std::optional<Nanoseconds>& before = last[message->channel];
          if (before && is_before(message->received, *before, kLate)) {
            return false;  // the recorder's clock was set back
          }
          before = message->received;
          late = late || (is_measured(topics[part.topics[message->channel]]) &&
                          is_before(message->received, block.received_before, kLate));
        }
      } catch (const InputError&) {
        // reported where the events are read
      }
    }
  }
  return late;
}

/// From the part's index, and from messages where a channel pauses for long; without an index from
/// all of its messages.
PartLayout layout_of(const RecordingPart& part, const std::vector<Topic>& topics) {
  constexpr int kLongPause = 100;  // share of its time: 1 %
  MessageLayout layout = part.file->layout();
  if (layout.channels.empty() && !part.topics.empty()) {
    return observed_layout(part, topics);
  }
  bool still = false;
  for (std::size_t i = 0; i < layout.channels.size() && !still; ++i) {
    const ChannelLayout& channel = layout.channels[i];
    const bool pauses = channel.received && channel.pause.length > Nanoseconds(0) &&
                        channel.pause.length >= length(*channel.received) / kLongPause;
    still = pauses && is_steady(topics[part.topics[i]]) && stands_still(part, topics, layout, i);
  }
  layout.grouped = layout.grouped && is_grouped(part, topics, layout);
  return {std::move(layout), still};
}

/// Where a topic is in a recording.
struct TopicExtent {
  std::optional<TimeSpan> received{};  ///< first by the index, then of the first and last message
  std::optional<TimeSpan> stamps{};    ///< of the same; none: they have none, or go back
  std::size_t first_part = 0;
  std::size_t last_part = 0;
  std::size_t last_channel = 0;
  uint64_t last = 0;  ///< ChannelLayout::last in the last part
};

struct Extents {
  std::map<std::size_t, TopicExtent> topics;  // those that are measured, by their number
  bool grouped = false;                       // within a part, or the parts are apart by topic
  bool stands_still = false;                  // PartLayout's, of some part
};

Extents extents_of(const std::vector<RecordingPart>& parts, const std::vector<Topic>& topics) {
  Extents extents;
  std::optional<Nanoseconds> newest;  // latest end of a topic in the parts so far
  bool steps_back = false;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto [layout, still] = layout_of(parts[p], topics);
    extents.stands_still = extents.stands_still || still;
    extents.grouped = extents.grouped || layout.grouped;
    std::optional<Nanoseconds> end;
    for (std::size_t i = 0; i < layout.channels.size(); ++i) {
      const std::optional<TimeSpan>& received = layout.channels[i].received;
      const std::size_t topic = parts[p].topics[i];
      if (!received || !is_measured(topics[topic])) {
        continue;
      }
      auto [found, is_new] = extents.topics.try_emplace(topic, TopicExtent{.first_part = p});
      TopicExtent& extent = found->second;
      steps_back = steps_back || (!is_new && extent.last_part != p &&
                                  is_before(received->begin, extent.received->end, kStep));
      extent.received = is_new ? *received
                               : TimeSpan{std::min(extent.received->begin, received->begin),
                                          std::max(extent.received->end, received->end)};
      extent.last_part = p;
      extent.last_channel = i;
      extent.last = layout.channels[i].last;
      end = std::max(end.value_or(received->end), received->end);
      extents.grouped = extents.grouped || (newest && is_before(received->begin, *newest, kLate));
    }
    if (end) {
      newest = std::max(newest.value_or(*end), *end);
    }
  }
  extents.grouped = extents.grouped && !steps_back;
  return extents;
}

/// A message's times.
struct MessageEnd {
  std::optional<Nanoseconds> received{};
  std::optional<Nanoseconds> stamp{};
};

/// Of the first, or the last, message.
MessageEnd find_end(const RecordingPart& part, MessageSelection selection, bool last) {
  MessageEnd end;
  selection.by_index = true;
  const auto stream = part.file->messages(selection);
  for (bool more = true; more;) {
    try {
      const std::optional<RawMessage> message = stream->next();
      more = message.has_value();
      if (message) {
        end = {message->received, stamp_in(part.file->channels()[message->channel], *message)};
        more = last;
      }
    } catch (const InputError&) {
      // reported where the events are read
    }
  }
  return end;
}

/// Differences of its times do not overflow.
bool is_plausible(const TimeSpan& span) {
  constexpr Nanoseconds kFarthestStamp = Nanoseconds::max() / 4;
  return span.begin >= -kFarthestStamp && span.end <= kFarthestStamp;
}

std::optional<TimeSpan> span_of(const std::optional<Nanoseconds>& begin,
                                const std::optional<Nanoseconds>& end) {
  return begin && end && *begin <= *end ? std::optional(TimeSpan{*begin, *end}) : std::nullopt;
}

/// Chunks are of several topics: the times of a topic are those of its first and last message.
void take_ends(TopicExtent& extent, const std::vector<RecordingPart>& parts, std::size_t topic) {
  const RecordingPart& first = parts[extent.first_part];
  MessageSelection selection;
  for (std::size_t i = 0; i < first.topics.size(); ++i) {
    if (first.topics[i] == topic) {
      selection.channels.push_back(i);
    }
  }
  const MessageEnd begin = find_end(first, selection, false);
  const MessageEnd end = find_end(parts[extent.last_part],
                                  {.channels = {extent.last_channel}, .from = extent.last}, true);
  const auto received = span_of(begin.received, end.received);
  if (received && is_plausible(*received)) {
    extent.received = received;
  }
  extent.stamps = span_of(begin.stamp, end.stamp);
}

/// Most of the shorter one lies within the other.
bool overlap(const TimeSpan& a, const TimeSpan& b) {
  const Nanoseconds shared = std::min(a.end, b.end) - std::max(a.begin, b.begin);
  const Nanoseconds shorter = std::min(length(a), length(b));
  return shared > Nanoseconds(0) && shared >= shorter / 2;
}

}  // namespace

MessageTimes times_of(const std::vector<RecordingPart>& parts, const std::vector<Topic>& topics) {
  if (std::ranges::count_if(topics, is_measured) < 2 ||
      std::ranges::all_of(parts, in_order_of_arrival)) {
    return {};
  }
  Extents extents = extents_of(parts, topics);
  for (auto& [topic, extent] : extents.topics) {
    take_ends(extent, parts, topic);
  }
  // By their times of receipt some topics are one behind the other. Is that so by their stamps?
  MessageTimes times;
  for (auto a = extents.topics.begin(); a != extents.topics.end(); ++a) {
    for (auto b = std::next(a); b != extents.topics.end(); ++b) {
      if (overlap(*a->second.received, *b->second.received)) {
        continue;
      }
      const std::optional<TimeSpan>& one = a->second.stamps;
      const std::optional<TimeSpan>& other = b->second.stamps;
      if (one && other && std::min(length(*one), length(*other)) > kLate && overlap(*one, *other)) {
        times.order = MessageOrder::stamps;
      }
    }
  }
  if (!extents.grouped && extents.stands_still) {
    times.order = MessageOrder::stamps;
  }
  if (times.order == MessageOrder::stamps) {
    for (const auto& [topic, extent] : extents.topics) {
      if (const std::optional<TimeSpan>& span = extent.stamps) {
        times.begin = std::min(times.begin.value_or(span->begin), span->begin);
      }
    }
    return times;
  }
  times.order = extents.grouped ? MessageOrder::received : MessageOrder::files;
  return times;
}

}  // namespace adit
