// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/live/recording_split.hpp"

namespace adit {

/// A UDP datagram as a socket received it.
struct ReceivedDatagram {
  Nanoseconds received{0};  ///< since 1970, by the kernel's clock
  uint32_t sender = 0;      ///< IPv4 addresses and ports in the host's byte order
  uint32_t receiver = 0;
  uint16_t sender_port = 0;
  uint16_t receiver_port = 0;
  std::span<const std::byte> payload;
};

/// Appends datagrams to a pcap file (nanoseconds, LINKTYPE_RAW). Another thread may read what
/// committed() covers while the file grows.
class PacketRecorder {
 public:
  /// Creates the file. Throws OutputError, also where it exists.
  explicit PacketRecorder(std::filesystem::path path, const RecordingSplit& split = {});
  ~PacketRecorder();
  PacketRecorder(const PacketRecorder&) = delete;
  PacketRecorder& operator=(const PacketRecorder&) = delete;

  /// Keeps the datagram until commit(). Throws OutputError where a next file cannot be begun.
  void add(const ReceivedDatagram& datagram);
  /// Writes what was added. Throws OutputError.
  void commit();
  /// Nothing follows.
  void finish() { finished_ = true; }

  const std::filesystem::path& path() const { return path_; }
  /// Bytes of whole packets in the file.
  uint64_t committed() const { return committed_; }
  bool finished() const { return finished_; }

 private:
  void open();

  RecordingParts parts_;
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::vector<std::byte> pending_;
  std::atomic<uint64_t> committed_ = 0;
  std::atomic<bool> finished_ = false;
};

}  // namespace adit
