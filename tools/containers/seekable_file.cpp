// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/seekable_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace adit {

SeekableFile::SeekableFile(std::filesystem::path path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) {
    const bool missing = errno == ENOENT;
    throw InputError(path_, {},
                     missing ? "there is no such file"
                             : std::string("cannot be opened: ") + std::strerror(errno),
                     missing ? "Check the path" : "Check the permissions");
  }
  struct stat status {};
  const bool known = ::fstat(descriptor_, &status) == 0;
  if (!known || !S_ISREG(status.st_mode)) {
    ::close(descriptor_);
    throw InputError(path_, {}, known ? "is not a regular file" : "cannot be looked at",
                     "Give a file that can be read");
  }
  size_ = static_cast<uint64_t>(status.st_size);
}

SeekableFile::~SeekableFile() {
  ::close(descriptor_);
}

void SeekableFile::require(uint64_t offset, uint64_t bytes) const {
  if (offset > size_ || bytes > size_ - offset) {
    throw InputError(path_, Place::byte(offset),
                     "the file ends at byte " + std::to_string(size_) + ", " +
                         std::to_string(bytes) + " bytes were expected from here on",
                     "The file is cut off: copy it again");
  }
}

void SeekableFile::read(uint64_t offset, std::span<std::byte> into) const {
  require(offset, into.size());
  std::size_t done = 0;
  while (done < into.size()) {
    const ssize_t got = ::pread(descriptor_, into.data() + done, into.size() - done,
                                static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      throw InputError(path_, Place::byte(offset + done),
                       got == 0 ? std::string("the file has become shorter while it was read")
                                : std::string("cannot be read: ") + std::strerror(errno),
                       got == 0 ? "Wait until it is written" : "Check the disk");
    }
    done += static_cast<std::size_t>(got);
  }
}

std::vector<std::byte> SeekableFile::read(uint64_t offset, uint64_t bytes) const {
  require(offset, bytes);
  std::vector<std::byte> content(bytes);
  read(offset, content);
  return content;
}

}  // namespace adit
