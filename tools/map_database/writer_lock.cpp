// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/writer_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

namespace adit {
namespace {

std::string own_name() {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) {
    host = {"this machine"};
  }
  return "process " + std::to_string(::getpid()) + " on " + host.data();
}

std::string content(int descriptor) {
  std::array<char, 512> text{};
  const ssize_t size = ::pread(descriptor, text.data(), text.size(), 0);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size))
                  : std::string("another process");
}

/// Whether the open file is still the one of that name: its last holder may have deleted it.
bool is_current(int descriptor, const std::filesystem::path& path) {
  struct stat open {};
  struct stat named {};
  return ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &named) == 0 &&
         open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

}  // namespace

WriterLock::WriterLock(const std::filesystem::path& file) : path_(file.string() + ".lock") {
  // writer_of() has a lock for less than a millisecond, which is no writer's.
  constexpr int kMostAttempts = 20;
  constexpr useconds_t kPause = 5000;  // microseconds
  int attempts = 0;
  while (descriptor_ < 0) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0) {
      throw OutputError(file, file.string() + ": cannot be written: " + path_.string() + ": " +
                                  std::strerror(errno) +
                                  ". Take a folder where you may write; reading needs no such "
                                  "right.");
    }
    // A file system without locks cannot tell writers apart.
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      const std::string holder = content(descriptor_);
      ::close(descriptor_);
      if (++attempts < kMostAttempts) {
        descriptor_ = -1;
        ::usleep(kPause);
        continue;
      }
      throw LockedError(file, file.string() + ": is being written by " + holder +
                                  ". Wait until that has ended; reading is possible meanwhile.");
    }
    if (!is_current(descriptor_, path_)) {
      ::close(descriptor_);
      descriptor_ = -1;
    }
  }
  // Who holds it is for others to read: that it cannot be written does no harm.
  const std::string name = own_name();
  if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, name.data(), name.size(), 0) < 0) {
    errno = 0;
  }
}

WriterLock::~WriterLock() {
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

std::optional<std::string> writer_of(const std::filesystem::path& file) {
  const int descriptor = ::open((file.string() + ".lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return std::nullopt;
  }
  std::optional<std::string> writer;
  if (::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    writer = content(descriptor);
  }
  ::close(descriptor);
  return writer;
}

}  // namespace adit
