// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Networks deliver packets late, in another order or twice (RFC 4737, RFC 5560), and captures on
// several interfaces at once record each of them. A sensor sends them once, in order.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/packets/packet_bytes.hpp"

namespace adit {

/// Where a packet belongs among those that its sensor sent.
struct PacketPlace {
  std::size_t series = 0;  ///< packets of one kind: ranges, or readings of the IMU
  Nanoseconds time{0};     ///< by the sensor's clock
  uint64_t content = 0;    ///< hash of the whole packet
};

/// What PacketOrder mended.
struct PacketOrderCounts {
  uint64_t repeated = 0;   ///< packets that came twice and were used once
  uint64_t reordered = 0;  ///< packets that came after a later one and were put before it
  uint64_t late = 0;       ///< packets that came too late for that and were left out
};

/// Passes items on in the order in which they came, except that the packets of each series take
/// each other's places until they are in the order of the sensor's clock, and that packets with
/// the same content are passed on once. Items in order come out as they went in.
///
/// `Item` can be moved and has `received`, the time of its place: a packet that changes places
/// takes that of its new one.
template <class Item>
class PacketOrder {
 public:
  /// An item that keeps its place.
  void add(Item item) { slots_.push_back({.item = std::move(item)}); }
  void add(Item item, const PacketPlace& place);

  /// The next item. Nothing until enough came after it, or with `end` until all were passed on.
  std::optional<Item> next(bool end);

  const PacketOrderCounts& counts() const { return counts_; }

 private:
  /// Items that wait for later ones. Networks that use several paths or queues deliver a packet
  /// a few places late; this is 85 ms of the slowest sensor's packets (VLP-16: 754 a second).
  static constexpr std::size_t kWindow = 64;
  /// Contents that are remembered: copies of a packet may be captured on two interfaces, with the
  /// delay of a bridge between them. Less than a second of any sensor.
  static constexpr std::size_t kRemembered = 512;
  /// So many packets in a row that come too late are a clock that was set back.
  static constexpr std::size_t kClockSetBack = 16;

  struct Slot {
    std::optional<Item> item{};  ///< nothing: the first that waits of the series
    std::size_t series = 0;
    Nanoseconds received{0};
  };
  struct Waiting {
    Nanoseconds time{0};
    Item item;
  };
  struct Series {
    std::deque<Waiting> waiting{};      ///< by time, of equal ones by arrival
    std::optional<Nanoseconds> last{};  ///< of the packet that was passed on last
    std::size_t late_in_row = 0;
    std::deque<uint64_t> contents{};  ///< by arrival
    std::unordered_set<uint64_t> known{};
  };

  bool is_repeated(Series& series, uint64_t content);
  bool is_late(Series& series, std::size_t number, Nanoseconds time);
  void settle(Series& series, std::size_t number);
  Item take_first(Series& series, const Slot& slot);

  std::deque<Slot> slots_;
  std::map<std::size_t, Series> series_;
  PacketOrderCounts counts_;
};

template <class Item>
bool PacketOrder<Item>::is_repeated(Series& series, uint64_t content) {
  if (!series.known.insert(content).second) {
    ++counts_.repeated;
    return true;
  }
  series.contents.push_back(content);
  if (series.contents.size() > kRemembered) {
    series.known.erase(series.contents.front());
    series.contents.pop_front();
  }
  return false;
}

/// True for a packet that is left out. Where the clock was set, the order begins anew.
template <class Item>
bool PacketOrder<Item>::is_late(Series& series, std::size_t number, Nanoseconds time) {
  const std::optional<Nanoseconds> newest =
      series.waiting.empty() ? series.last : std::optional(series.waiting.back().time);
  if (newest && (time - *newest > kLongestTurn || *newest - time > kLongestTurn)) {
    settle(series, number);
  }
  if (!series.last || time >= *series.last) {
    series.late_in_row = 0;
    return false;
  }
  if (++series.late_in_row < kClockSetBack) {
    ++counts_.late;
    return true;
  }
  settle(series, number);
  return false;
}

/// What waits gets its places for good; later packets are not put before it.
template <class Item>
void PacketOrder<Item>::settle(Series& series, std::size_t number) {
  for (Slot& slot : slots_) {
    if (!slot.item && slot.series == number) {
      slot.item = take_first(series, slot);
    }
  }
  series.last.reset();
  series.late_in_row = 0;
}

template <class Item>
Item PacketOrder<Item>::take_first(Series& series, const Slot& slot) {
  Waiting first = std::move(series.waiting.front());
  series.waiting.pop_front();
  series.last = first.time;
  first.item.received = slot.received;
  return std::move(first.item);
}

template <class Item>
void PacketOrder<Item>::add(Item item, const PacketPlace& place) {
  Series& series = series_[place.series];
  if (is_repeated(series, place.content) || is_late(series, place.series, place.time)) {
    return;
  }
  const auto after = std::ranges::upper_bound(series.waiting, place.time, {}, &Waiting::time);
  counts_.reordered += after != series.waiting.end() ? 1U : 0U;
  slots_.push_back({.item = std::nullopt, .series = place.series, .received = item.received});
  series.waiting.insert(after, Waiting{place.time, std::move(item)});
}

template <class Item>
std::optional<Item> PacketOrder<Item>::next(bool end) {
  if (slots_.empty() || (!slots_.front().item && !end && slots_.size() <= kWindow)) {
    return std::nullopt;
  }
  Slot slot = std::move(slots_.front());
  slots_.pop_front();
  return slot.item ? std::move(slot.item)
                   : std::optional(take_first(series_.at(slot.series), slot));
}

}  // namespace adit
