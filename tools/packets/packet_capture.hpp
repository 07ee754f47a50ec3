// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Captures of network packets: pcap (as tcpdump and Wireshark write it, micro- and nanoseconds) and
// pcapng (draft-ietf-opsawg-pcapng). What is of interest are the UDP datagrams in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/byte_reader.hpp"
#include "adit/tools/containers/seekable_file.hpp"
#include "adit/tools/packets/datagram_assembly.hpp"

namespace adit {

/// True where the file begins like a capture.
bool is_packet_capture(const std::filesystem::path& path);

/// The datagrams of a capture, in the order of the file.
class PacketCapture {
 public:
  /// `file` must outlive it. Throws InputError where it is no capture.
  explicit PacketCapture(const SeekableFile& file);

  /// Nothing at the end. Throws InputError where a record makes no sense or the file ends within
  /// one; what comes after is not found again: the call after that finds the end.
  std::optional<Datagram> next();

  /// What was no whole datagram so far.
  const DatagramCounts& counts() const { return assembly_.counts(); }

 private:
  struct Interface {
    uint32_t link = 0;
    double tick = 1e-6;  ///< s
    int64_t offset = 0;  ///< s
  };

  std::vector<std::byte> read(uint64_t bytes, const char* what);
  std::optional<CapturedPacket> next_packet();
  std::optional<CapturedPacket> next_pcap();
  std::optional<CapturedPacket> next_pcapng();
  void read_section(std::span<const std::byte> body);
  void read_interface(std::span<const std::byte> body);
  std::optional<CapturedPacket> read_enhanced(std::span<const std::byte> body);
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
  DatagramAssembly assembly_;
};

}  // namespace adit
