// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ordered_packets.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace adit {

std::vector<Event> OrderedPackets::decode(bool end) {
  std::vector<Event> events;
  while (const std::optional<Held> held = order_.next(end)) {
    Datagram datagram = held->datagram;
    datagram.received = held->received;
    datagram.payload = held->payload;
    std::ranges::move(decoder_.take(datagram), std::back_inserter(events));
  }
  return events;
}

std::vector<Event> OrderedPackets::take(const Datagram& datagram) {
  Held held{.received = datagram.received,
            .datagram = datagram,
            .payload = {datagram.payload.begin(), datagram.payload.end()}};
  if (const std::optional<PacketPlace> place = place_of(datagram, *sensor_)) {
    order_.add(std::move(held), *place);
  } else {
    order_.add(std::move(held));
  }
  return decode(false);
}

std::vector<Event> OrderedPackets::flush() {
  return decode(true);
}

}  // namespace adit
