// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/json_log.hpp"

#include <array>
#include <chrono>
#include <ctime>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace adit {
namespace {

std::string time_now() {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  return fmt::format("{}.{:03}Z", std::string(text.data(), size), ms);
}

/// Takes the word and the colon away where the line begins with them.
bool take_prefix(std::string& line, const std::string& prefix) {
  if (!line.starts_with(prefix)) {
    return false;
  }
  line.erase(0, prefix.size());
  return true;
}

}  // namespace

std::string json_log_line(const std::string& line, const std::string& time) {
  std::string message = line;
  std::string level = "info";
  take_prefix(message, "note: ");
  if (take_prefix(message, "adit live: ") || take_prefix(message, "adit run: ")) {
    level = "error";
  }
  if (take_prefix(message, "warning: ")) {
    level = "warning";
  }
  const nlohmann::ordered_json json = {{"time", time}, {"level", level}, {"message", message}};
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

JsonLog::~JsonLog() {
  const std::scoped_lock lock(mutex_);
  end_line();
}

void JsonLog::take(char character) {
  if (character == '\n' || character == '\r') {
    end_line();
  } else {
    line_ += character;
  }
}

void JsonLog::end_line() {
  if (!line_.empty()) {
    out_ << (json_log_line(line_, time_now()) + "\n") << std::flush;
    line_.clear();
  }
}

JsonLog::int_type JsonLog::overflow(int_type character) {
  const std::scoped_lock lock(mutex_);
  if (!traits_type::eq_int_type(character, traits_type::eof())) {
    take(traits_type::to_char_type(character));
  }
  return traits_type::not_eof(character);
}

std::streamsize JsonLog::xsputn(const char* text, std::streamsize size) {
  const std::scoped_lock lock(mutex_);
  for (std::streamsize i = 0; i < size; ++i) {
    take(text[i]);
  }
  return size;
}

int JsonLog::sync() {
  return out_ ? 0 : -1;
}

}  // namespace adit
