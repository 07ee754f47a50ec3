// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/packet_capture.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

namespace adit {
namespace {

constexpr uint32_t kMicroseconds = 0xa1b2c3d4;
constexpr uint32_t kNanoseconds = 0xa1b23c4d;
constexpr uint32_t kSection = 0x0a0d0d0a;
constexpr uint32_t kByteOrder = 0x1a2b3c4d;
constexpr uint64_t kLargestPacket = 1U << 20U;  // bytes; a datagram has 64 KiB at most
constexpr uint64_t kLargestBlock = 1U << 24U;

uint32_t swap(uint32_t v) {
  return (v >> 24U) | ((v >> 8U) & 0xff00U) | ((v << 8U) & 0xff0000U) | (v << 24U);
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

std::optional<CapturedPacket> PacketCapture::next_pcap() {
  const uint64_t begin = at_;
  const std::vector<std::byte> header = read(16, "a packet's header");
  const uint64_t size = u32(header, 8);
  if (size > kLargestPacket) {
    fail(begin, "a packet of " + std::to_string(size) + " bytes; 1 MiB is the most");
  }
  packet_ = read(size, "a packet");
  const auto ticks_ns = static_cast<int64_t>(u32(header, 4)) * (pcap_.tick < 1e-7 ? 1 : 1000);
  return CapturedPacket{.received = std::chrono::seconds(u32(header, 0)) + Nanoseconds(ticks_ns),
                        .link = pcap_.link,
                        .bytes = packet_,
                        .cut = u32(header, 12) > size,
                        .offset = begin};
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

std::optional<CapturedPacket> PacketCapture::read_enhanced(std::span<const std::byte> body) {
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
  return CapturedPacket{.received = std::chrono::seconds(seconds + from.offset) + nanoseconds(rest),
                        .link = from.link,
                        .bytes = packet_,
                        .cut = u32(body, 16) > size};
}

std::optional<CapturedPacket> PacketCapture::next_pcapng() {
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
      std::optional<CapturedPacket> packet = read_enhanced(body);
      packet->offset = begin;
      return packet;
    }  // other kinds of blocks tell nothing that is needed
  }
  return std::nullopt;
}

std::optional<CapturedPacket> PacketCapture::next_packet() {
  if (at_ >= file_->size()) {
    return std::nullopt;
  }
  return next_generation_ ? next_pcapng() : next_pcap();
}

std::optional<Datagram> PacketCapture::next() {
  while (const std::optional<CapturedPacket> packet = next_packet()) {
    if (const std::optional<Datagram> datagram = assembly_.take(*packet)) {
      return datagram;
    }
  }
  return std::nullopt;
}

}  // namespace adit
