// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/packet_capture.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <tuple>

namespace adit {
namespace {

constexpr uint32_t kMicroseconds = 0xa1b2c3d4;
constexpr uint32_t kNanoseconds = 0xa1b23c4d;
constexpr uint32_t kSection = 0x0a0d0d0a;
constexpr uint32_t kByteOrder = 0x1a2b3c4d;
constexpr uint64_t kLargestPacket = 1U << 20U;  // bytes; a datagram has 64 KiB at most
constexpr uint64_t kLargestBlock = 1U << 24U;
constexpr std::size_t kLargestDatagram = 65536;
constexpr std::size_t kMostFragments = 64;

uint32_t swap(uint32_t v) {
  return (v >> 24U) | ((v >> 8U) & 0xff00U) | ((v << 8U) & 0xff0000U) | (v << 24U);
}

/// Numbers of the network are big-endian.
uint16_t net16(std::span<const std::byte> from, std::size_t at) {
  return static_cast<uint16_t>((std::to_integer<unsigned>(from[at]) << 8U) |
                               std::to_integer<unsigned>(from[at + 1]));
}
uint32_t net32(std::span<const std::byte> from, std::size_t at) {
  return (uint32_t{net16(from, at)} << 16U) | net16(from, at + 2);
}

uint32_t first_word(const SeekableFile& file) {
  uint32_t word = 0;
  if (file.size() >= 4) {
    file.read(0, std::as_writable_bytes(std::span(&word, 1)));
  }
  return word;
}

bool is_pcap(uint32_t word) {
  return word == kMicroseconds || word == kNanoseconds;
}

/// Where the network layer begins and what it is (EtherType); nothing where it is of no interest.
struct Network {
  std::size_t begin = 0;
  unsigned type = 0;
};
std::optional<Network> network_of(uint32_t link, std::span<const std::byte> packet) {
  constexpr unsigned kIpv4 = 0x0800;
  constexpr unsigned kIpv6 = 0x86dd;
  const auto has = [&](std::size_t size) { return packet.size() >= size; };
  switch (link) {
    case 1: {  // Ethernet, with up to two tags of virtual networks
      std::size_t at = 12;
      while (has(at + 2) && (net16(packet, at) == 0x8100 || net16(packet, at) == 0x88a8) &&
             at < 20) {
        at += 4;
      }
      return has(at + 2) ? std::optional(Network{at + 2, net16(packet, at)}) : std::nullopt;
    }
    case 0:  // loopback, the family in the writer's byte order
      return Network{4,
                     has(5) && (std::to_integer<unsigned>(packet[4]) >> 4U) == 6 ? kIpv6 : kIpv4};
    case 12:
    case 101:  // IP without a link layer
      return Network{0,
                     has(1) && (std::to_integer<unsigned>(packet[0]) >> 4U) == 6 ? kIpv6 : kIpv4};
    case 113:  // Linux, "any" device
      return has(16) ? std::optional(Network{16, net16(packet, 14)}) : std::nullopt;
    case 276:  // the same, second version
      return has(20) ? std::optional(Network{20, net16(packet, 0)}) : std::nullopt;
    default:
      return std::nullopt;
  }
}

/// Fills in port and payload from a UDP header on; nothing where it is cut off.
std::optional<Datagram> from_udp(std::span<const std::byte> udp, Datagram datagram) {
  constexpr std::size_t kHeader = 8;
  if (udp.size() < kHeader) {
    return std::nullopt;
  }
  const std::size_t size = net16(udp, 4);
  if (size < kHeader || size > udp.size()) {
    return std::nullopt;  // captured in part
  }
  datagram.port = net16(udp, 2);
  datagram.payload = udp.subspan(kHeader, size - kHeader);
  return datagram;
}

}  // namespace

bool is_packet_capture(const std::filesystem::path& path) {
  const uint32_t word = first_word(SeekableFile(path));
  return is_pcap(word) || is_pcap(swap(word)) || word == kSection;
}

PacketCapture::PacketCapture(const SeekableFile& file) : file_(&file) {
  const uint32_t word = first_word(file);
  next_generation_ = word == kSection;
  if (next_generation_) {
    return;
  }
  if (!is_pcap(word) && !is_pcap(swap(word))) {
    fail(0, "it does not begin like a pcap or pcapng file");
  }
  swapped_ = !is_pcap(word);
  const std::vector<std::byte> header = read(24, "the header");
  pcap_ = {.link = u32(header, 20) & 0xffffU, .tick = u32(header, 0) == kNanoseconds ? 1e-9 : 1e-6};
}

void PacketCapture::fail(uint64_t at, const std::string& found) {
  at_ = file_->size();
  throw InputError(file_->path(), Place::byte(at), found,
                   "The file is damaged or cut off: copy it again, or use what lies before");
}

uint32_t PacketCapture::u32(std::span<const std::byte> from, std::size_t at) const {
  uint32_t value = 0;
  std::memcpy(&value, from.subspan(at, 4).data(), 4);
  return swapped_ ? swap(value) : value;
}

uint16_t PacketCapture::u16(std::span<const std::byte> from, std::size_t at) const {
  uint16_t value = 0;
  std::memcpy(&value, from.subspan(at, 2).data(), 2);
  return swapped_ ? static_cast<uint16_t>((value >> 8U) | (value << 8U)) : value;
}

std::vector<std::byte> PacketCapture::read(uint64_t bytes, const char* what) {
  if (bytes > file_->size() - at_) {
    fail(at_, std::string(what) + " needs " + std::to_string(bytes) + " bytes, " +
                  std::to_string(file_->size() - at_) + " are left");
  }
  std::vector<std::byte> content = file_->read(at_, bytes);
  at_ += bytes;
  return content;
}

std::optional<PacketCapture::Packet> PacketCapture::next_pcap() {
  const uint64_t begin = at_;
  const std::vector<std::byte> header = read(16, "a packet's header");
  const uint64_t size = u32(header, 8);
  if (size > kLargestPacket) {
    fail(begin, "a packet of " + std::to_string(size) + " bytes; 1 MiB is the most");
  }
  packet_ = read(size, "a packet");
  const auto ticks_ns = static_cast<int64_t>(u32(header, 4)) * (pcap_.tick < 1e-7 ? 1 : 1000);
  return Packet{.received = std::chrono::seconds(u32(header, 0)) + Nanoseconds(ticks_ns),
                .link = pcap_.link,
                .begin = begin,
                .size = size};
}

void PacketCapture::read_section(std::span<const std::byte> body) {
  if (body.size() < 16) {
    fail(at_, "a section header of " + std::to_string(body.size()) + " bytes");
  }
  interfaces_.clear();
}

void PacketCapture::read_interface(std::span<const std::byte> body) {
  constexpr std::size_t kMostInterfaces = 65536;
  if (body.size() < 8 || interfaces_.size() >= kMostInterfaces) {
    fail(at_, "an interface description that makes no sense");
  }
  Interface one{.link = u16(body, 0)};
  std::size_t at = 8;
  while (at + 4 <= body.size()) {
    const unsigned code = u16(body, at);
    const std::size_t length = u16(body, at + 2);
    at += 4;
    if (code == 0 || length > body.size() - at) {
      break;
    }
    if (code == 9 && length >= 1) {  // if_tsresol: a power of ten, or of two
      const auto value = std::to_integer<unsigned>(body[at]);
      one.tick = std::pow(value > 127 ? 2.0 : 10.0, -static_cast<double>(value & 127U));
    } else if (code == 14 && length >= 8) {  // if_tsoffset
      one.offset = static_cast<int32_t>(u32(body, at));
    }
    at += (length + 3) / 4 * 4;
  }
  interfaces_.push_back(one);
}

std::optional<PacketCapture::Packet> PacketCapture::read_enhanced(std::span<const std::byte> body) {
  if (body.size() < 20) {
    fail(at_, "a packet block of " + std::to_string(body.size()) + " bytes");
  }
  const uint32_t interface = u32(body, 0);
  const uint64_t size = u32(body, 12);
  if (interface >= interfaces_.size() || size > body.size() - 20) {
    fail(at_, "a packet of an interface or a length that is not there");
  }
  const Interface& from = interfaces_[interface];
  const uint64_t ticks = (uint64_t{u32(body, 4)} << 32U) | u32(body, 8);
  const double per_second = std::round(1.0 / from.tick);
  const auto whole = static_cast<uint64_t>(std::min(per_second, 1e18));
  const auto seconds = static_cast<int64_t>(std::min<uint64_t>(ticks / whole, 9'000'000'000U));
  const double rest = static_cast<double>(ticks % whole) * from.tick;
  packet_.assign(body.begin() + 20, body.begin() + 20 + static_cast<std::ptrdiff_t>(size));
  return Packet{.received = std::chrono::seconds(seconds + from.offset) + nanoseconds(rest),
                .link = from.link,
                .begin = at_,
                .size = size};
}

std::optional<PacketCapture::Packet> PacketCapture::next_pcapng() {
  while (at_ < file_->size()) {
    const uint64_t begin = at_;
    const std::vector<std::byte> head = read(12, "a block's header");
    uint32_t type = u32(head, 0);
    if (u32(head, 0) == kSection || swap(u32(head, 0)) == kSection) {
      type = kSection;
      swapped_ = false;
      if (u32(head, 8) != kByteOrder) {
        swapped_ = true;
        if (u32(head, 8) != kByteOrder) {
          fail(begin + 8, "a section whose byte order cannot be told");
        }
      }
    }
    const uint64_t length = u32(head, 4);
    if (length < 12 || length % 4 != 0 || length > kLargestBlock) {
      fail(begin + 4, "a block of " + std::to_string(length) + " bytes");
    }
    at_ = begin + 8;
    const std::vector<std::byte> rest = read(length - 8, "a block");
    const std::span<const std::byte> body = std::span(rest).first(rest.size() - 4);
    if (type == kSection) {
      read_section(body);
    } else if (type == 1) {
      read_interface(body);
    } else if (type == 6) {
      std::optional<Packet> packet = read_enhanced(body);
      packet->begin = begin;
      return packet;
    }  // other kinds of blocks tell nothing that is needed
  }
  return std::nullopt;
}

std::optional<PacketCapture::Packet> PacketCapture::next_packet() {
  if (at_ >= file_->size()) {
    return std::nullopt;
  }
  return next_generation_ ? next_pcapng() : next_pcap();
}

std::optional<std::span<const std::byte>> PacketCapture::reassemble(
    const FragmentKey& key, std::size_t at, bool last, std::span<const std::byte> bytes) {
  if (at + bytes.size() > kLargestDatagram) {
    return std::nullopt;
  }
  if (!fragments_.contains(key) && fragments_.size() >= kMostFragments) {
    fragments_.erase(std::ranges::min_element(
        fragments_, {}, [](const auto& entry) { return entry.second.order; }));
  }
  Fragments& all = fragments_[key];
  all.order = ++order_;
  all.bytes.resize(std::max(all.bytes.size(), at + bytes.size()));
  all.known.resize((all.bytes.size() + 7) / 8);
  std::ranges::copy(bytes, all.bytes.begin() + static_cast<std::ptrdiff_t>(at));
  for (std::size_t i = at / 8; i < (at + bytes.size() + 7) / 8; ++i) {
    all.known[i] = true;
  }
  if (last) {
    all.size = at + bytes.size();
  }
  if (!all.size || *all.size != all.bytes.size() ||
      std::ranges::find(all.known, false) != all.known.end()) {
    return std::nullopt;
  }
  whole_ = std::move(all.bytes);
  fragments_.erase(key);
  return std::span<const std::byte>(whole_);
}

std::optional<Datagram> PacketCapture::from_ipv4(std::span<const std::byte> ip, Datagram datagram) {
  constexpr unsigned kUdp = 17;
  if (ip.size() < 20) {
    return std::nullopt;
  }
  const std::size_t header = 4U * (std::to_integer<std::size_t>(ip[0]) & 15U);
  const std::size_t total = net16(ip, 2);
  if (header < 20 || total < header || total > ip.size() ||
      std::to_integer<unsigned>(ip[9]) != kUdp) {
    return std::nullopt;
  }
  const std::span<const std::byte> body = ip.subspan(header, total - header);
  datagram.source = net32(ip, 12);
  const unsigned flags = net16(ip, 6);
  const std::size_t at = 8U * (flags & 0x1fffU);
  const bool more = (flags & 0x2000U) != 0;
  if (at == 0 && !more) {
    return from_udp(body, datagram);
  }
  const auto whole = reassemble({datagram.source, net32(ip, 16), net16(ip, 4)}, at, !more, body);
  return whole ? from_udp(*whole, datagram) : std::nullopt;
}

std::optional<Datagram> PacketCapture::datagram_of(const Packet& packet) {
  const std::span<const std::byte> bytes(packet_);
  const std::optional<Network> network = network_of(packet.link, bytes);
  if (!network || network->begin > bytes.size()) {
    return std::nullopt;
  }
  const std::span<const std::byte> ip = bytes.subspan(network->begin);
  const Datagram datagram{.received = packet.received, .payload = {}, .offset = packet.begin};
  if (network->type == 0x0800) {
    return from_ipv4(ip, datagram);
  }
  constexpr std::size_t kIpv6Header = 40;
  const bool udp6 =
      network->type == 0x86dd && ip.size() >= kIpv6Header && std::to_integer<unsigned>(ip[6]) == 17;
  return udp6 ? from_udp(ip.subspan(kIpv6Header), datagram) : std::nullopt;
}

std::optional<Datagram> PacketCapture::next() {
  while (const std::optional<Packet> packet = next_packet()) {
    if (const std::optional<Datagram> datagram = datagram_of(*packet)) {
      return datagram;
    }
  }
  return std::nullopt;
}

}  // namespace adit
