// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/unfinished_map.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

namespace adit {
namespace {

namespace fs = std::filesystem;

void synchronize(const fs::path& file, int flags) {
  const int descriptor = ::open(file.c_str(), flags | O_CLOEXEC);
  const bool done = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int reason = errno;
  if (descriptor >= 0) {
    ::close(descriptor);
  }
  if (!done) {
    throw OutputError(file, file.string() + ": cannot be written: " + std::strerror(reason) + ".");
  }
}

}  // namespace

UnfinishedMap::UnfinishedMap(const fs::path& whole)
    : lock_(whole),
      whole_(whole),
      part_(whole.string() + ".part"),
      rows_(part_.string() + ".rows") {
  remove_all();
}

UnfinishedMap::~UnfinishedMap() {
  remove_all();
}

void UnfinishedMap::take_its_place() const {
  std::error_code error;
  const auto log = fs::file_size(part_.string() + "-wal", error);
  if (!error && log > 0) {
    throw OutputError(part_, part_.string() + ": its log could not be written into it.");
  }
  synchronize(part_, O_RDWR);
  if (fs::exists(whole_, error)) {
    throw OutputError(whole_, whole_.string() + ": somebody else has made it meanwhile.");
  }
  fs::rename(part_, whole_, error);
  if (error) {
    throw OutputError(whole_, whole_.string() + ": cannot be written: " + error.message() + ".");
  }
  synchronize(fs::absolute(whole_).parent_path(), O_RDONLY | O_DIRECTORY);
}

void UnfinishedMap::remove_all() const {
  std::error_code ignored;
  for (const fs::path& file : {part_, rows_}) {
    for (const char* suffix : {"", "-wal", "-shm", "-journal", ".lock"}) {
      fs::remove(file.string() + suffix, ignored);
    }
  }
}

}  // namespace adit
