// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/live/disk_reserve.hpp"
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

/// Where receivers' datagrams go. All of it may throw OutputError. Threads may share it.
class PacketSink {
 public:
  PacketSink() = default;
  virtual ~PacketSink() = default;
  PacketSink(const PacketSink&) = delete;
  PacketSink& operator=(const PacketSink&) = delete;

  /// Keeps the datagram until commit().
  virtual void add(const ReceivedDatagram& datagram) = 0;
  /// Writes what was added. Called now and then, also while nothing arrives.
  virtual void commit() = 0;
  /// Nothing follows.
  virtual void finish() = 0;
};

/// Appends datagrams to a pcap file (nanoseconds, LINKTYPE_RAW). Another thread may read what
/// committed() covers while the file grows.
class PacketRecorder final : public PacketSink {
 public:
  /// Creates the file. Throws OutputError, also where it exists.
  explicit PacketRecorder(std::filesystem::path path, const RecordingSplit& split = {});
  ~PacketRecorder() override;

  /// Nothing is added after finish().
  void add(const ReceivedDatagram& datagram) override;
  void commit() override;
  void finish() override { finished_ = true; }

  const std::filesystem::path& path() const { return path_; }
  /// Bytes of whole packets in the file.
  uint64_t committed() const { return committed_; }
  bool finished() const { return finished_; }
  /// Of the disk, while others read what it records.
  DiskReserve& reserve() const { return *reserve_; }

 private:
  void open();
  void write_pending();

  std::mutex mutex_;  ///< of the file
  std::unique_ptr<DiskReserve> reserve_ = std::make_unique<DiskReserve>();
  RecordingParts parts_;
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::vector<std::byte> pending_;
  std::atomic<uint64_t> committed_ = 0;
  std::atomic<bool> finished_ = false;
};

}  // namespace adit
