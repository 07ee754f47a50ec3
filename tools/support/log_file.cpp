// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/log_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr std::string_view kTimeShape = "0000-00-00T00:00:00.000Z ";

/// The file's first line begins with a time, as all lines of logs do; or there is none.
bool may_be_log(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    return true;  // opening it tells
  }
  std::ifstream stream(path, std::ios::binary);
  std::string begin(kTimeShape.size(), '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(stream.gcount()));
  bool fits = begin.empty() || begin.size() == kTimeShape.size();
  for (std::size_t i = 0; i < begin.size(); ++i) {
    const bool digit = std::isdigit(static_cast<unsigned char>(begin[i])) != 0;
    fits = fits && (kTimeShape[i] == '0' ? digit : begin[i] == kTimeShape[i]);
  }
  return fits;
}

}  // namespace

std::vector<std::string> LogLines::take(std::string_view text) {
  std::vector<std::string> lines;
  for (const char c : text) {
    if (in_escape_) {
      if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
        in_escape_ = false;
        if (c == 'K') {  // erases to the end of the line, which was drawn over
          line_.clear();
        }
      }
    } else if (c == '\x1b') {
      in_escape_ = true;
    } else if (c == '\r') {
      line_.clear();
    } else if (c != '\n') {
      line_ += c;
    } else if (!line_.empty()) {
      lines.push_back(std::exchange(line_, {}));
    }
  }
  return lines;
}

std::string LogLines::rest() {
  return std::exchange(line_, {});
}

std::string utc_text(std::chrono::system_clock::time_point time) {
  const auto milliseconds = std::chrono::floor<std::chrono::milliseconds>(time);
  const auto whole = std::chrono::floor<std::chrono::seconds>(milliseconds);
  const std::time_t seconds = std::chrono::system_clock::to_time_t(whole);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", parts.tm_year + 1900,
                     parts.tm_mon + 1, parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec,
                     (milliseconds - whole).count());
}

LogFile::LogFile(std::filesystem::path path) : path_(std::move(path)) {
  if (!may_be_log(path_)) {
    throw OutputError(path_, path_.string() +
                                 ": it holds something else than a log, and is left as it is. "
                                 "Name another file for --log.");
  }
  constexpr mode_t kMode = S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH;
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, kMode);
  if (descriptor_ < 0) {
    throw OutputError(path_, path_.string() +
                                 ": the log cannot be written: " + std::strerror(errno) +
                                 ". Name a file for --log in a folder that is yours to write to.");
  }
}

LogFile::~LogFile() {
  ::close(descriptor_);
}

void LogFile::write(std::string_view line, std::chrono::system_clock::time_point time) {
  const std::string text = utc_text(time) + " " + std::string(line) + "\n";
  std::size_t written = 0;
  while (written < text.size() && failure_.empty()) {
    const ssize_t bytes = ::write(descriptor_, text.data() + written, text.size() - written);
    if (bytes >= 0) {
      written += static_cast<std::size_t>(bytes);
    } else if (errno != EINTR) {
      failure_ = path_.string() + ": the log is not whole: " + std::strerror(errno) + ".";
    }
  }
}

}  // namespace adit
