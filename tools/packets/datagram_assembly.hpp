// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// From captured packets of a network to UDP datagrams: link layers (Ethernet with VLAN tags, Linux
// "cooked" captures, loopback, IP without a link layer), IPv4 and IPv6, fragments.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// A UDP datagram of a capture.
struct Datagram {
  Nanoseconds received{0};             ///< by the capture's clock
  uint32_t source = 0;                 ///< IPv4 address; of IPv6, the exclusive or of its words
  uint16_t port = 0;                   ///< the receiver's
  std::span<const std::byte> payload;  ///< valid until the next datagram is asked for
  uint64_t offset = 0;                 ///< byte of the file where its (last) packet begins
  std::size_t missing = 0;             ///< bytes of the payload's end that were not captured

  /// Size of the payload as it was sent.
  std::size_t sent() const { return payload.size() + missing; }
};

/// A packet as a network interface captured it.
struct CapturedPacket {
  Nanoseconds received{0};
  uint32_t link = 0;                 ///< LINKTYPE_ value of the interface
  std::span<const std::byte> bytes;  ///< from the link layer on
  bool cut = false;                  ///< the packet was longer than what was captured
  uint64_t offset = 0;               ///< byte of the file where it begins
};

/// What of a capture was no whole datagram.
struct DatagramCounts {
  uint64_t cut = 0;                             ///< datagrams of which the end was not captured
  uint64_t incomplete = 0;                      ///< datagrams of which fragments were not captured
  uint64_t repeated = 0;                        ///< fragments that were captured twice
  std::map<uint32_t, uint64_t> unread_links{};  ///< packets of link layers that are not read
};

/// Takes packets in the order of the capture; gives the datagrams in them. Fragments are put
/// together in any order, up to 64 KiB each and 64 datagrams at a time. What is no UDP is ignored.
class DatagramAssembly {
 public:
  /// Nothing where the packet completes no datagram. The payload lies in the packet's bytes or
  /// here, and is valid until the next call.
  std::optional<Datagram> take(const CapturedPacket& packet);

  const DatagramCounts& counts() const { return counts_; }

 private:
  /// Source and destination (IPv4 in the first bytes of each), and the datagram's number.
  using FragmentKey = std::pair<std::array<std::byte, 32>, uint32_t>;
  struct Fragments {
    std::vector<std::byte> bytes{};
    std::vector<bool> known{};          ///< for each 8 bytes
    std::optional<std::size_t> size{};  ///< known with the last fragment
    Nanoseconds begin{0};               ///< when the first fragment was received
    uint64_t order = 0;
    bool complete = false;  ///< handed out; kept to recognise fragments that come twice
  };
  struct Fragment {
    FragmentKey key{};
    std::size_t at = 0;  ///< byte of the datagram
    bool last = false;
    std::span<const std::byte> bytes{};
  };

  std::optional<Datagram> from_ipv4(std::span<const std::byte> ip, Datagram datagram, bool cut);
  std::optional<Datagram> from_ipv6(std::span<const std::byte> ip, Datagram datagram, bool cut);
  std::optional<Datagram> from_udp(std::span<const std::byte> udp, Datagram datagram, bool cut);
  std::optional<Datagram> from_fragment(const Fragment& fragment, const Datagram& datagram);
  bool is_other_datagram(const Fragments& all, const Fragment& fragment,
                         Nanoseconds received) const;
  void forget(std::map<FragmentKey, Fragments>::iterator entry);

  std::map<FragmentKey, Fragments> fragments_;
  std::vector<std::byte> whole_;
  uint64_t order_ = 0;
  DatagramCounts counts_;
};

}  // namespace adit
