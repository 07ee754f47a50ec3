// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/datagram_assembly.hpp"

#include <algorithm>

namespace adit {
namespace {

constexpr std::size_t kLargestDatagram = 65536;
constexpr std::size_t kMostFragmented = 64;
/// Hosts give up waiting for fragments after half a minute (Linux: ipfrag_time); after that the
/// number of a datagram may belong to another one.
constexpr Nanoseconds kFragmentsWait = std::chrono::seconds(30);
constexpr unsigned kUdpProtocol = 17;
constexpr unsigned kIpv4 = 0x0800;  // EtherTypes
constexpr unsigned kIpv6 = 0x86dd;

unsigned net8(std::span<const std::byte> from, std::size_t at) {
  return std::to_integer<unsigned>(from[at]);
}
/// Numbers of the network are big-endian.
uint16_t net16(std::span<const std::byte> from, std::size_t at) {
  return static_cast<uint16_t>((net8(from, at) << 8U) | net8(from, at + 1));
}
uint32_t net32(std::span<const std::byte> from, std::size_t at) {
  return (uint32_t{net16(from, at)} << 16U) | net16(from, at + 2);
}

/// Where the network layer begins, and its EtherType.
struct NetworkLayer {
  std::size_t begin = 0;
  unsigned type = 0;
};

/// Behind an EtherType at `at`, and the tags of virtual networks (802.1Q, 802.1ad, and the two
/// types that were in use before it).
std::optional<NetworkLayer> after_type(std::span<const std::byte> packet, std::size_t at) {
  const auto is_tag = [](unsigned type) {
    return type == 0x8100 || type == 0x88a8 || type == 0x9100 || type == 0x9200;
  };
  while (at + 2 <= packet.size() && is_tag(net16(packet, at))) {
    at += 4;
  }
  return at + 2 <= packet.size() ? std::optional(NetworkLayer{at + 2, net16(packet, at)})
                                 : std::nullopt;
}

/// IP at `at`, whose version is in its first half byte.
std::optional<NetworkLayer> bare_ip(std::span<const std::byte> packet, std::size_t at) {
  if (at >= packet.size()) {
    return std::nullopt;
  }
  return NetworkLayer{at, (net8(packet, at) >> 4U) == 6 ? kIpv6 : kIpv4};
}

bool is_read(uint32_t link) {
  constexpr std::array<uint32_t, 10> kLinks = {0, 1, 12, 14, 101, 108, 113, 228, 229, 276};
  return std::ranges::find(kLinks, link) != kLinks.end();
}

/// By LINKTYPE_ (https://www.tcpdump.org/linktypes.html).
std::optional<NetworkLayer> network_layer(uint32_t link, std::span<const std::byte> packet) {
  switch (link) {
    case 1:  // Ethernet
      return after_type(packet, 12);
    case 113:  // Linux, "any" device
      return after_type(packet, 14);
    case 276: {  // the same, second version: the type comes first, tags are behind the header
      if (packet.size() < 20) {
        return std::nullopt;
      }
      const unsigned type = net16(packet, 0);
      return type == kIpv4 || type == kIpv6 ? std::optional(NetworkLayer{20, type})
                                            : after_type(packet, 22);
    }
    case 0:
    case 108:  // loopback, behind the address family
      return bare_ip(packet, 4);
    default:  // 12, 14, 101: raw IP; 228: IPv4; 229: IPv6
      return bare_ip(packet, 0);
  }
}

}  // namespace

std::optional<Datagram> DatagramAssembly::take(const CapturedPacket& packet) {
  if (!is_read(packet.link)) {
    ++counts_.unread_links[packet.link];
    return std::nullopt;
  }
  const std::optional<NetworkLayer> network = network_layer(packet.link, packet.bytes);
  if (!network || network->begin > packet.bytes.size()) {
    return std::nullopt;
  }
  const std::span<const std::byte> ip = packet.bytes.subspan(network->begin);
  const Datagram datagram{.received = packet.received, .payload = {}, .offset = packet.offset};
  if (network->type == kIpv4) {
    return from_ipv4(ip, datagram, packet.cut);
  }
  return network->type == kIpv6 ? from_ipv6(ip, datagram, packet.cut) : std::nullopt;
}

std::optional<Datagram> DatagramAssembly::from_ipv4(std::span<const std::byte> ip,
                                                    Datagram datagram, bool cut) {
  if (ip.size() < 20) {
    return std::nullopt;
  }
  const std::size_t header = 4U * (net8(ip, 0) & 15U);
  const std::size_t total = net16(ip, 2);
  if (header < 20 || header > ip.size() || total < header || (total > ip.size() && !cut) ||
      net8(ip, 9) != kUdpProtocol) {
    return std::nullopt;
  }
  const std::span<const std::byte> body = ip.subspan(header, std::min(total, ip.size()) - header);
  datagram.source = net32(ip, 12);
  const unsigned flags = net16(ip, 6);
  const std::size_t at = 8U * (flags & 0x1fffU);
  const bool more = (flags & 0x2000U) != 0;
  if (at == 0 && !more) {
    return from_udp(body, datagram, cut);
  }
  Fragment fragment{.at = at, .last = !more && total <= ip.size(), .bytes = body};
  std::ranges::copy(ip.subspan(12, 4), fragment.key.first.begin());
  std::ranges::copy(ip.subspan(16, 4), fragment.key.first.begin() + 16);
  fragment.key.second = net16(ip, 4);
  return from_fragment(fragment, datagram);
}

std::optional<Datagram> DatagramAssembly::from_ipv6(std::span<const std::byte> ip,
                                                    Datagram datagram, bool cut) {
  constexpr std::size_t kHeader = 40;
  constexpr unsigned kHopByHop = 0;
  constexpr unsigned kRouting = 43;
  constexpr unsigned kFragment = 44;
  constexpr unsigned kDestination = 60;
  if (ip.size() < kHeader) {
    return std::nullopt;
  }
  const std::size_t total = kHeader + net16(ip, 4);
  if (total > ip.size() && !cut) {
    return std::nullopt;
  }
  const std::span<const std::byte> packet = ip.first(std::min(total, ip.size()));
  for (std::size_t word = 8; word < 24; word += 4) {
    datagram.source ^= net32(packet, word);
  }
  unsigned next = net8(packet, 6);
  std::size_t at = kHeader;
  while (next == kHopByHop || next == kRouting || next == kDestination) {
    if (at + 8 > packet.size()) {
      return std::nullopt;
    }
    next = net8(packet, at);
    at += 8U * (1U + net8(packet, at + 1));
  }
  if (at > packet.size()) {
    return std::nullopt;
  }
  if (next == kUdpProtocol) {
    return from_udp(packet.subspan(at), datagram, cut);
  }
  if (next != kFragment || at + 8 > packet.size() || net8(packet, at) != kUdpProtocol) {
    return std::nullopt;
  }
  const unsigned flags = net16(packet, at + 2);
  Fragment fragment{.at = flags & 0xfff8U,
                    .last = (flags & 1U) == 0 && total <= ip.size(),
                    .bytes = packet.subspan(at + 8)};
  std::ranges::copy(packet.subspan(8, 32), fragment.key.first.begin());
  fragment.key.second = net32(packet, at + 4);
  return from_fragment(fragment, datagram);
}

/// Fills in port and payload from a UDP header on; nothing where it is not there.
std::optional<Datagram> DatagramAssembly::from_udp(std::span<const std::byte> udp,
                                                   Datagram datagram, bool cut) {
  constexpr std::size_t kHeader = 8;
  if (udp.size() < kHeader) {
    return std::nullopt;
  }
  const std::size_t size = net16(udp, 4);
  if (size < kHeader || (size > udp.size() && !cut)) {
    return std::nullopt;
  }
  datagram.port = net16(udp, 2);
  datagram.payload = udp.subspan(kHeader, std::min(size, udp.size()) - kHeader);
  datagram.missing = size - kHeader - datagram.payload.size();
  counts_.cut += datagram.missing > 0 ? 1U : 0U;
  return datagram;
}

/// True where what is known under the fragment's key belongs to another datagram: it is too old, or
/// says otherwise.
bool DatagramAssembly::is_other_datagram(const Fragments& all, const Fragment& fragment,
                                         Nanoseconds received) const {
  const Nanoseconds wait = received - all.begin;
  if (wait > kFragmentsWait || wait < -kFragmentsWait) {
    return true;
  }
  const std::vector<std::byte>& bytes = all.bytes;
  for (std::size_t i = 0; i < fragment.bytes.size() && fragment.at + i < bytes.size(); ++i) {
    if (all.known[(fragment.at + i) / 8] && bytes[fragment.at + i] != fragment.bytes[i]) {
      return true;
    }
  }
  return all.complete && fragment.at + fragment.bytes.size() > bytes.size();
}

void DatagramAssembly::forget(std::map<FragmentKey, Fragments>::iterator entry) {
  counts_.incomplete += entry->second.complete ? 0U : 1U;
  fragments_.erase(entry);
}

std::optional<Datagram> DatagramAssembly::from_fragment(const Fragment& fragment,
                                                        const Datagram& datagram) {
  const std::size_t end = fragment.at + fragment.bytes.size();
  if (end > kLargestDatagram) {
    return std::nullopt;
  }
  auto found = fragments_.find(fragment.key);
  if (found != fragments_.end() && is_other_datagram(found->second, fragment, datagram.received)) {
    forget(found);
    found = fragments_.end();
  }
  if (found == fragments_.end()) {
    if (fragments_.size() >= kMostFragmented) {
      forget(std::ranges::min_element(fragments_, {},
                                      [](const auto& entry) { return entry.second.order; }));
    }
    found = fragments_.emplace(fragment.key, Fragments{.begin = datagram.received}).first;
  }
  Fragments& all = found->second;
  all.order = ++order_;
  if (all.complete) {
    ++counts_.repeated;
    return std::nullopt;
  }
  all.bytes.resize(std::max(all.bytes.size(), end));
  all.known.resize((all.bytes.size() + 7) / 8);
  std::ranges::copy(fragment.bytes, all.bytes.begin() + static_cast<std::ptrdiff_t>(fragment.at));
  for (std::size_t i = fragment.at / 8; i < (end + 7) / 8; ++i) {
    all.known[i] = true;
  }
  if (fragment.last) {
    all.size = end;
  }
  if (!all.size || *all.size != all.bytes.size() ||
      std::ranges::find(all.known, false) != all.known.end()) {
    return std::nullopt;
  }
  all.complete = true;
  whole_ = all.bytes;
  return from_udp(whole_, datagram, false);
}

}  // namespace adit
