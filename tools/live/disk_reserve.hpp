// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string>

namespace adit {

/// Leaves room on the disk for the map where a recording fills it: what is written from then on is
/// freed once all have read it, and cut off at the end. Threads may share it.
class DiskReserve {
 public:
  /// Nothing is freed until begin().
  DiskReserve() = default;
  ~DiskReserve();
  DiskReserve(const DiskReserve&) = delete;
  DiskReserve& operator=(const DiskReserve&) = delete;

  /// `say`, if there is one, is given a note, once. `least` bytes stay free besides the results of
  /// what is recorded; without it a tenth of the disk, 1 GiB at most, for what is mapped later.
  void begin(const std::filesystem::path& recording, std::function<void(const std::string&)> say,
             std::optional<uint64_t> least = std::nullopt);

  /// The recording has whole records up to there.
  void written(uint64_t end);
  /// How much of the recording stays; nothing where that is all.
  std::optional<uint64_t> kept() const;
  /// Once nobody reads: cuts off what does not stay.
  void cut();

  /// Where one reads the recording.
  class Reader {
   public:
    Reader(DiskReserve& reserve, uint64_t at);
    ~Reader();
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    /// It has read the records up to there. Returns where it goes on: there, or beyond what is
    /// freed.
    uint64_t read(uint64_t at);

   private:
    DiskReserve* reserve_;
    std::list<uint64_t>::iterator place_;
  };

 private:
  void free_what_is_read();

  mutable std::mutex mutex_;
  std::filesystem::path recording_;
  std::function<void(const std::string&)> say_;
  uint64_t least_ = 0;
  uint64_t looked_ = 0;  ///< the recording's length when the disk was looked at
  std::optional<uint64_t> kept_{};
  uint64_t freed_ = 0;  ///< end of what is freed, from kept_ on
  int descriptor_ = -1;
  std::list<uint64_t> readers_;
};

}  // namespace adit
