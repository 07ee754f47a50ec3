// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How every command speaks: --color, --log and --verbose.
#pragma once

#include <chrono>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "adit/tools/support/color.hpp"

namespace adit {

class Command;

struct ConsoleOptions {
  ColorChoice color = ColorChoice::automatic;
  std::optional<std::filesystem::path> log{};  ///< none: no log
  bool verbose = false;                        ///< details are shown, too
};

/// Adds the options to a command.
void add_console_options(Command command, ConsoleOptions& options);

/// What --color says among the words, which are not parsed yet: complaints about them are coloured,
/// too. Words that make no sense count as none.
ColorChoice color_among(std::span<const char* const> words);

/// The standard streams, in colour where that is wanted, for as long as it lives.
class Console {
 public:
  explicit Console(ColorChoice color);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// Once the command line is read: opens the log, and writes into it what is run, by which build,
  /// in which environment. Throws OutputError where the log cannot be written.
  void begin(const ConsoleOptions& options, std::span<const char* const> words);

  /// Writes the end into the log. Returns the exit code: the command's, or 1 where all was well but
  /// the log.
  int end(int code);

 private:
  class Redirected;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace adit
