// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "adit/tools/map_database/writer_lock.hpp"

namespace adit {

/// A new map while it is being written, in MAP.part, and rows for it that were found elsewhere,
/// beside that. What an earlier attempt has left there goes, and so does all of it where the
/// attempt does not come to an end.
class UnfinishedMap {
 public:
  /// Throws LockedError where another process makes the map, or OutputError.
  explicit UnfinishedMap(const std::filesystem::path& whole);
  ~UnfinishedMap();
  UnfinishedMap(const UnfinishedMap&) = delete;
  UnfinishedMap& operator=(const UnfinishedMap&) = delete;

  const std::filesystem::path& part() const { return part_; }
  const std::filesystem::path& rows() const { return rows_; }

  /// Nobody may have it open any more. Throws OutputError, also where there is a map of that name
  /// by now.
  void take_its_place() const;

 private:
  void remove_all() const;

  WriterLock lock_;
  std::filesystem::path whole_;
  std::filesystem::path part_;
  std::filesystem::path rows_;
};

}  // namespace adit
