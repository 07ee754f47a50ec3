// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/scratch_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include "adit/tools/support/input_error.hpp"

namespace adit {

ScratchFile::ScratchFile(std::filesystem::path beside) : beside_(std::move(beside)) {
  std::string name = beside_.string() + ".XXXXXX";
  file_ = mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) {
    fail("made");
  }
  if (unlink(name.c_str()) != 0) {
    const int reason = errno;
    ::close(file_);
    errno = reason;
    fail("made nameless");
  }
}

ScratchFile::~ScratchFile() {
  if (file_ >= 0) {
    ::close(file_);
  }
}

void ScratchFile::write_at(uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written <= 0) {
      fail("written");
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<uint64_t>(written);
  }
  size_ = std::max(size_, offset);
}

void ScratchFile::read_at(uint64_t offset, std::span<char> bytes) const {
  while (!bytes.empty()) {
    const ssize_t read = pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (read < 0 && errno == EINTR) {
      continue;
    }
    if (read <= 0) {
      fail("read");
    }
    bytes = bytes.subspan(static_cast<std::size_t>(read));
    offset += static_cast<uint64_t>(read);
  }
}

void ScratchFile::fail(std::string_view attempted) const {
  const int code = errno;
  throw OutputError(
      beside_, fmt::format("{}: a temporary file beside it cannot be {}: {}.{}", beside_.string(),
                           attempted, std::error_code(code, std::generic_category()).message(),
                           code == ENOSPC ? " Free some space or write to another disk." : ""));
}

}  // namespace adit
