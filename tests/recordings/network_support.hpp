// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Captures on other networks than an Ethernet on which every packet arrives once, whole and in
// order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "adit/tests/recordings/packet_support.hpp"

namespace adit::test {

using Frames = std::vector<CapturedFrame>;

/// The IPv4 packet in a frame of frames_of().
inline Bytes ip_of(const Bytes& frame) {
  return {frame.begin() + 14, frame.end()};
}

/// The same datagram over IPv6, in fragments of `most` bytes where it is longer.
inline std::vector<Bytes> ipv6_of(const Bytes& frame, std::size_t most = 65000, uint32_t id = 7) {
  const Bytes udp(frame.begin() + 34, frame.end());
  std::vector<Bytes> packets;
  for (std::size_t at = 0; at < udp.size(); at += most) {
    const std::size_t size = std::min(most, udp.size() - at);
    const bool fragment = udp.size() > most;
    Bytes packet(40);
    packet[0] = std::byte{0x60};
    // Hop-by-hop options of 8 bytes come first in all.
    put_network(packet, 4, static_cast<uint16_t>(8 + (fragment ? 8 : 0) + size));
    packet[6] = std::byte{0};
    packet[8] = std::byte{0xfe};
    packet[23] = std::byte{1};
    Bytes options(8);
    options[0] = fragment ? std::byte{44} : std::byte{17};
    append(packet, options);
    if (fragment) {
      Bytes header(8);
      header[0] = std::byte{17};
      put_network(header, 2, static_cast<uint16_t>(at | (at + size < udp.size() ? 1U : 0U)));
      put(header, 4, id);
      append(packet, header);
    }
    append(packet, std::span(udp).subspan(at, size));
    packets.push_back(std::move(packet));
  }
  return packets;
}

/// `head` before each IPv4 packet.
inline Frames behind(const Frames& frames, const Bytes& head) {
  Frames all;
  for (const CapturedFrame& frame : frames) {
    Bytes bytes = head;
    append(bytes, ip_of(frame.bytes));
    all.push_back({frame.received, std::move(bytes)});
  }
  return all;
}

/// An Ethernet header with the tags of virtual networks.
inline Bytes tagged_ethernet(const std::vector<uint16_t>& tags) {
  Bytes head(12);
  for (const uint16_t tag : tags) {
    put_network(head, head.size(), tag);
    put_network(head, head.size(), 10);
  }
  put_network(head, head.size(), 0x0800);
  return head;
}

inline Bytes pcap_of_link(const Frames& frames, uint32_t link) {
  Bytes file = pcap(frames);
  put(file, 20, link);
  return file;
}

/// A capture of which at most `snap` bytes of a packet were kept.
inline Bytes snapped_pcap(const Frames& frames, std::size_t snap) {
  Bytes file = pcap({});
  for (const CapturedFrame& frame : frames) {
    Bytes one =
        pcap({{frame.received,
               {frame.bytes.begin(), frame.bytes.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                               snap, frame.bytes.size()))}}});
    put(one, 24 + 12, static_cast<uint32_t>(frame.bytes.size()));
    append(file, std::span(one).subspan(24));
  }
  return file;
}

/// Every packet twice, the copy so many packets later.
inline Frames twice(const Frames& frames, std::size_t later) {
  Frames all;
  for (std::size_t i = 0; i < frames.size() + later; ++i) {
    if (i < frames.size()) {
      all.push_back(frames[i]);
    }
    if (i >= later) {
      all.push_back({all.back().received, frames[i - later].bytes});
    }
  }
  return all;
}

/// Every packet whose number divides by `every` comes `later` packets later; times of reception
/// stay where they are.
inline Frames reordered(const Frames& frames, std::size_t every, std::size_t later) {
  Frames all = frames;
  for (std::size_t i = 1; i + later < all.size(); i += every) {
    for (std::size_t k = i; k < i + later; ++k) {
      std::swap(all[k].bytes, all[k + 1].bytes);
    }
  }
  return all;
}

}  // namespace adit::test
