// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)) {
  file_ = std::fopen(path_.c_str(), "wb");
  if (file_ == nullptr) {
    fail("cannot create it");
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) {
    static_cast<void>(std::fclose(file_));
  }
}

void OutputFile::fail(std::string_view attempted) const {
  const int reason = errno;
  std::string message = path_.string() + ": " + std::string(attempted);
  if (reason != 0) {
    message += ": ";
    message += std::strerror(reason);
  }
  message += ".";
  if (reason == ENOSPC) {
    message += " Free some space or write to another disk.";
  } else if (reason == ENOENT || reason == EACCES || reason == EROFS) {
    message += " Write to a folder that exists and is yours to write to.";
  }
  throw OutputError(path_, message);
}

void OutputFile::write(const void* data, std::size_t bytes) {
  errno = 0;
  if (bytes > 0 && std::fwrite(data, 1, bytes, file_) != bytes) {
    fail("cannot write to it");
  }
}

void OutputFile::overwrite(uint64_t offset, std::string_view text) {
  errno = 0;
  if (std::fseek(file_, static_cast<long>(offset), SEEK_SET) != 0 ||
      std::fwrite(text.data(), 1, text.size(), file_) != text.size() ||
      std::fseek(file_, 0, SEEK_END) != 0) {
    fail("cannot write to it");
  }
}

void OutputFile::flush() {
  errno = 0;
  if (std::fflush(file_) != 0) {
    fail("cannot write to it");
  }
}

void OutputFile::close() {
  if (file_ == nullptr) {
    return;
  }
  flush();
  errno = 0;
  if (std::fclose(std::exchange(file_, nullptr)) != 0) {
    fail("cannot close it");
  }
}

std::filesystem::path Draft::path_of(const std::filesystem::path& file) {
  return file.string() + ".part";
}

Draft::Draft(std::filesystem::path file) : file_(std::move(file)), path_(path_of(file_)) {}

Draft::~Draft() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void Draft::take_its_place() {
  std::error_code error;
  std::filesystem::rename(path_, file_, error);
  if (error) {
    throw OutputError(file_, file_.string() + ": cannot be written: " + error.message() + ".");
  }
}

void write_text_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.close();
}

void replace_text_file(const std::filesystem::path& path, const std::string& text) {
  try {
    Draft draft(path);
    write_text_file(draft.path(), text);
    draft.take_its_place();
  } catch (const OutputError&) {
    std::error_code unknown;
    const std::string old =
        std::filesystem::is_regular_file(path, unknown) ? read_text_file(path) : std::string();
    try {
      write_text_file(path, text);
    } catch (const OutputError&) {
      if (!old.empty()) {
        write_text_file(path, old);
      }
      throw;
    }
  }
}

void append_number(std::string& line, double value) {
  line += shortest(value);
}

void append_stamp(std::string& line, Nanoseconds stamp) {
  const int64_t count = stamp.count();
  const uint64_t magnitude =
      count < 0 ? uint64_t{0} - static_cast<uint64_t>(count) : static_cast<uint64_t>(count);
  line += fmt::format("{}{}.{:09}", count < 0 ? "-" : "", magnitude / 1'000'000'000U,
                      magnitude % 1'000'000'000U);
}

}  // namespace adit
