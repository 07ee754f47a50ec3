// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/console.hpp"

#include <unistd.h>

#include <iostream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/invocation.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/message_buffer.hpp"
#include "adit/tools/support/resident_memory.hpp"

namespace adit {
namespace {

using SteadyClock = std::chrono::steady_clock;

std::vector<std::pair<std::string, ColorChoice>> color_words() {
  return {{"auto", ColorChoice::automatic},
          {"always", ColorChoice::always},
          {"never", ColorChoice::never}};
}

}  // namespace

/// A stream's buffer, replaced for as long as this lives.
class Console::Redirected {
 public:
  explicit Redirected(std::ostream& stream)
      : stream_(stream), before_(*stream.rdbuf()), buffer_(before_) {
    stream_.rdbuf(&buffer_);
  }
  ~Redirected() { stream_.rdbuf(&before_); }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

  MessageBuffer& buffer() { return buffer_; }

 private:
  std::ostream& stream_;
  std::streambuf& before_;
  MessageBuffer buffer_;
};

struct Console::Parts {
  std::optional<LogFile> log{};  // outlives what writes to it
  Redirected messages{std::cerr};
  std::optional<Redirected> report{};  // only in colour: else it goes as it always has
  MessageSettings settings{};
  SteadyClock::time_point start = SteadyClock::now();
};

void add_console_options(Command command, ConsoleOptions& options) {
  command
      .choice<ColorChoice>("--color",
                           "Colours for complaints, notes and verdicts; auto: on a terminal, as "
                           "NO_COLOR and CLICOLOR_FORCE say",
                           options.color, color_words())
      .of_every_command();
  command
      .option("--log", options.log,
              "Write all messages to the end of this file, too, with their time (UTC)")
      .value_name("FILE")
      .of_every_command();
  command
      .flag("--verbose", options.verbose,
            "Say more: build, device, settings, and time and memory at the end")
      .of_every_command();
}

ColorChoice color_among(std::span<const char* const> words) {
  constexpr std::string_view kOption = "--color";
  ColorChoice found = ColorChoice::automatic;
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string_view word = words[i];
    if (word == kOption && i + 1 < words.size()) {
      word = words[i + 1];
    } else if (word.starts_with(kOption) && word.substr(kOption.size()).starts_with('=')) {
      word.remove_prefix(kOption.size() + 1);
    } else {
      continue;
    }
    for (const auto& [name, choice] : color_words()) {
      found = word == name ? choice : found;
    }
  }
  return found;
}

Console::Console(ColorChoice color) : parts_(std::make_unique<Parts>()) {
  if (wants_color(color, surroundings_of(STDERR_FILENO))) {
    parts_->settings.colors = message_opening;
  }
  if (wants_color(color, surroundings_of(STDOUT_FILENO))) {
    parts_->report.emplace(std::cout);
    parts_->report->buffer().use({.colors = report_opening});
  }
  parts_->messages.buffer().use(parts_->settings);
}

Console::~Console() = default;

void Console::begin(const ConsoleOptions& options, std::span<const char* const> words) {
  MessageSettings& settings = parts_->settings;
  if (options.log) {
    parts_->log.emplace(*options.log);
    settings.log = &*parts_->log;
  }
  settings.details = options.verbose;
  parts_->messages.buffer().use(settings);
  for (const std::string& line : describe_invocation(words)) {
    say_detail(std::cerr, line);
  }
  if (parts_->log && !parts_->log->failure().empty()) {
    throw OutputError(*options.log, parts_->log->failure() + " Nothing was begun.");
  }
}

int Console::end(int code) {
  const double seconds = std::chrono::duration<double>(SteadyClock::now() - parts_->start).count();
  constexpr double kBytesPerMiB = 1048576.0;
  say_detail(std::cerr,
             fmt::format("exit code {} after {:.1f} s, {:.0f} MiB resident at most", code, seconds,
                         static_cast<double>(peak_resident_bytes()) / kBytesPerMiB));
  if (!parts_->log || parts_->log->failure().empty()) {
    return code;
  }
  std::cerr << "adit: " << parts_->log->failure() << std::endl;
  return code == 0 ? 1 : code;
}

}  // namespace adit
