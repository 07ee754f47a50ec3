// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "adit/slam/core/types.hpp"

namespace adit {

/// When a recorder goes on in the next file.
struct RecordingSplit {
  Nanoseconds duration{0};  ///< of receiving; 0: never
  uint64_t bytes = 0;       ///< of a file; 0: never

  bool operator==(const RecordingSplit&) const = default;
};

/// Names the files of a recording, and says when one is full.
class RecordingParts {
 public:
  RecordingParts(std::filesystem::path whole, RecordingSplit split)
      : whole_(std::move(whole)), split_(split) {}

  /// "drive.mcap" where it is not split, else "drive_0.mcap" and so on.
  std::filesystem::path path() const {
    if (split_ == RecordingSplit{}) {
      return whole_;
    }
    std::filesystem::path path = whole_;
    path.replace_filename(whole_.stem().string() + "_" + std::to_string(number_) +
                          whole_.extension().string());
    return path;
  }

  /// Whether what is received now belongs into the next file, given the bytes of this one. Then
  /// path() is that one's.
  bool advance(Nanoseconds received, uint64_t bytes) {
    begin_ = begin_.value_or(received);
    const bool full = (split_.duration > Nanoseconds(0) && received - *begin_ >= split_.duration) ||
                      (split_.bytes > 0 && bytes >= split_.bytes);
    if (full) {
      ++number_;
      begin_ = received;
    }
    return full;
  }

 private:
  std::filesystem::path whole_;
  RecordingSplit split_;
  std::size_t number_ = 0;
  std::optional<Nanoseconds> begin_{};  ///< of this file
};

}  // namespace adit
