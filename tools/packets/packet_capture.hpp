// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Captures of network packets: pcap (as tcpdump and Wireshark write it, micro- and nanoseconds) and
// pcapng (draft-ietf-opsawg-pcapng). What is of interest are the UDP datagrams in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/byte_reader.hpp"
#include "adit/tools/containers/seekable_file.hpp"

namespace adit {

struct Datagram {
  Nanoseconds received{0};             ///< by the capture's clock
  uint32_t source = 0;                 ///< IPv4 address; 0 for IPv6
  uint16_t port = 0;                   ///< the receiver's
  std::span<const std::byte> payload;  ///< valid until the next call of next()
  uint64_t offset = 0;                 ///< byte of the file where its (last) packet begins
};

/// True where the file begins like a capture.
bool is_packet_capture(const std::filesystem::path& path);

/// The datagrams of a capture, in the order of the file. Fragments of IPv4 are put together, up to
/// 64 KiB each and 64 at a time; what is no UDP is passed over.
class PacketCapture {
 public:
  /// `file` must outlive it. Throws InputError where it is no capture.
  explicit PacketCapture(const SeekableFile& file);

  /// Nothing at the end. Throws InputError where a record makes no sense or the file ends within
  /// one; what comes after is not found again: the call after that finds the end.
  std::optional<Datagram> next();

 private:
  /// A packet as it was captured.
  struct Packet {
    Nanoseconds received{0};
    uint32_t link = 0;  ///< kind of the link layer
    uint64_t begin = 0;
    uint64_t size = 0;
  };
  struct Interface {
    uint32_t link = 0;
    double tick = 1e-6;  ///< s
    int64_t offset = 0;  ///< s
  };
  struct Fragments {
    std::vector<std::byte> bytes;
    std::vector<bool> known;  ///< eighths of a kilobit: 8 bytes each
    std::optional<std::size_t> size;
    uint64_t order = 0;
  };
  using FragmentKey = std::tuple<uint32_t, uint32_t, uint16_t>;  // source, destination, id

  std::vector<std::byte> read(uint64_t bytes, const char* what);
  std::optional<Packet> next_packet();
  std::optional<Packet> next_pcap();
  std::optional<Packet> next_pcapng();
  void read_section(std::span<const std::byte> body);
  void read_interface(std::span<const std::byte> body);
  std::optional<Packet> read_enhanced(std::span<const std::byte> body);
  std::optional<Datagram> datagram_of(const Packet& packet);
  std::optional<Datagram> from_ipv4(std::span<const std::byte> ip, Datagram datagram);
  std::optional<std::span<const std::byte>> reassemble(const FragmentKey& key, std::size_t at,
                                                       bool last, std::span<const std::byte> bytes);
  uint32_t u32(std::span<const std::byte> from, std::size_t at) const;
  uint16_t u16(std::span<const std::byte> from, std::size_t at) const;
  [[noreturn]] void fail(uint64_t at, const std::string& found);

  const SeekableFile* file_;
  bool swapped_ = false;  // numbers are in the other byte order
  bool next_generation_ = false;
  uint64_t at_ = 0;
  Interface pcap_;
  std::vector<Interface> interfaces_;
  std::vector<std::byte> packet_;
  std::vector<std::byte> whole_;
  std::map<FragmentKey, Fragments> fragments_;
  uint64_t order_ = 0;
};

}  // namespace adit
