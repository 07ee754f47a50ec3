// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/live/disk_reserve.hpp"
#include "adit/tools/live/recording_split.hpp"

namespace adit {

/// Where receivers' messages go. All of it may throw OutputError. Threads may share it.
class MessageSink {
 public:
  MessageSink() = default;
  virtual ~MessageSink() = default;
  MessageSink(const MessageSink&) = delete;
  MessageSink& operator=(const MessageSink&) = delete;

  virtual void write(std::size_t channel, Nanoseconds received,
                     std::span<const std::byte> bytes) = 0;
  /// Called now and then, also while nothing arrives.
  virtual void commit() {}
  /// Nothing follows.
  virtual void finish() = 0;
  /// Nothing follows, and what is written is left as it is.
  virtual void abandon() = 0;
};

/// Appends messages to an MCAP file without chunks, so that a program that is killed loses none
/// that was written. Another thread may read what committed() covers while the file grows.
class MessageRecorder final : public MessageSink {
 public:
  /// Creates the file, with CDR channels. Throws OutputError.
  MessageRecorder(std::filesystem::path path, std::vector<Channel> channels,
                  const RecordingSplit& split = {});

  /// Nothing is written after finish().
  void write(std::size_t channel, Nanoseconds received, std::span<const std::byte> bytes) override;
  void finish() override;
  void abandon() override { finished_ = true; }

  /// Of the file that is written, where it is one.
  const std::filesystem::path& path() const { return path_; }
  const std::vector<Channel>& channels() const { return channels_; }
  /// Bytes of whole records in the file that is written.
  uint64_t committed() const { return committed_; }
  /// committed() before the first message.
  uint64_t begin() const { return begin_; }
  bool finished() const { return finished_; }
  /// Of the disk, while others read what it records.
  DiskReserve& reserve() const { return *reserve_; }

 private:
  void open();

  std::mutex mutex_;  ///< of the file
  std::unique_ptr<DiskReserve> reserve_ = std::make_unique<DiskReserve>();
  RecordingParts parts_;
  std::filesystem::path path_;
  std::vector<Channel> channels_;
  std::unique_ptr<McapWriter> writer_;
  uint64_t begin_ = 0;
  std::atomic<uint64_t> committed_ = 0;
  std::atomic<bool> finished_ = false;
};

}  // namespace adit
