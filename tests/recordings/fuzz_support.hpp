// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the entries of the fuzzers share: a file, and what a reader owes whatever the
// bytes.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit::test {

/// A file with that content, in memory alone as a rule.
class ScratchFile {
 public:
  ScratchFile(const uint8_t* data, std::size_t size) {
    const std::string_view content(reinterpret_cast<const char*>(data), size);
    if (content.starts_with("SQLite")) {  // SQLite opens no file without a name
      static const TemporaryFolder folder;
      path_ = folder.write("input", content);
      return;
    }
    descriptor_ = ::memfd_create("input", 0);
    if (descriptor_ < 0 || ::write(descriptor_, data, size) != static_cast<ssize_t>(size)) {
      std::abort();
    }
    path_ = "/proc/self/fd/" + std::to_string(descriptor_);
  }
  ~ScratchFile() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;
};

/// What every sweep promises to those that use it.
inline void require_valid(const Sweep& sweep) {
  const std::size_t n = sweep.points.size();
  bool valid = sweep.offset.cwiseAbs().maxCoeff() <= 1e8;
  valid = valid && (sweep.times.empty() || sweep.times.size() == n) &&
          (sweep.rings.empty() || sweep.rings.size() == n) &&
          (sweep.doppler.empty() || sweep.doppler.size() == n);
  for (const float time : sweep.times) {
    valid = valid && time >= 0.0F && time <= 10.0F;
  }
  if (!valid) {
    std::abort();
  }
}

/// Reads to the end. An error must bring the stream on: more of them than bytes are a hang.
inline void require_readable(const Recording& recording, std::size_t size) {
  const auto events = recording.events({});
  std::size_t errors = 0;
  while (errors <= size + 1) {
    try {
      const auto event = events->next();
      if (!event) {
        return;
      }
      if (const auto* sweep = std::get_if<Sweep>(&event->value)) {
        require_valid(*sweep);
      }
    } catch (const InputError&) {
      ++errors;
    }
  }
  std::abort();
}

}  // namespace adit::test
