// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/invocation.hpp"

#include <cctype>
#include <cstdlib>
#include <string_view>

#include <fmt/core.h>

#include "adit/tools/support/commit.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

/// A word as a shell takes it.
std::string shell_word(std::string_view word) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("-_./=:,@%+").find(static_cast<char>(c)) != std::string_view::npos;
  };
  std::string quoted = "'";
  bool all_plain = !word.empty();
  for (const char c : word) {
    all_plain = all_plain && plain(static_cast<unsigned char>(c));
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return all_plain ? std::string(word) : quoted + "'";
}

std::string command_text(std::span<const char* const> words) {
  std::string text;
  for (const char* word : words) {
    text += (text.empty() ? "" : " ") + shell_word(word);
  }
  return text;
}

/// What is set of the variables that decide on the device.
std::string environment_text() {
  std::string text;
  for (const char* name :
       {"ADIT_DEVICE", "VK_DRIVER_FILES", "VK_ICD_FILENAMES", "LP_NUM_THREADS"}) {
    if (const char* value = std::getenv(name)) {
      text += (text.empty() ? "" : " ") + std::string(name) + "=" + shell_word(value);
    }
  }
  return text.empty() ? "the environment names no device" : text;
}

}  // namespace

std::vector<std::string> describe_invocation(std::span<const char* const> words) {
  return {fmt::format("adit {}, commit {}, {}", version(), commit(), build_type()),
          "it runs: " + command_text(words), environment_text()};
}

}  // namespace adit
