// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/tools/packets/packet_order.hpp"
#include "adit/tools/recordings/packet_decoder.hpp"

namespace adit {

/// The datagrams of a sensor as they were received, to events in the order in which the sensor sent
/// the datagrams (PacketOrder).
class OrderedPackets {
 public:
  /// `sensor` must outlive it. Without `points`, sweeps are only told apart.
  OrderedPackets(const PacketSensor& sensor, bool points)
      : sensor_(&sensor), decoder_(sensor, points) {}

  /// Nothing as a rule: it takes many packets to make a sweep.
  std::vector<Event> take(const Datagram& datagram);
  /// Of the datagrams that were kept back until later ones came.
  std::vector<Event> flush();
  /// What is left at the end, after flush().
  std::optional<Event> finish() { return decoder_.finish(); }

  const PacketOrderCounts& counts() const { return order_.counts(); }

 private:
  struct Held {
    Nanoseconds received{0};
    Datagram datagram;
    std::vector<std::byte> payload;
  };
  std::vector<Event> decode(bool end);

  const PacketSensor* sensor_;
  PacketOrder<Held> order_;
  PacketDecoder decoder_;
};

}  // namespace adit
