// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <string_view>

#include <fmt/core.h>

#include "adit/tools/support/message_buffer.hpp"

namespace adit {
namespace {

using namespace std::chrono_literals;

constexpr auto kRedrawEvery = 100ms;
constexpr auto kLineEvery = 5s;
constexpr auto kLineNotBefore = 1s;

int percent(const ProgressState& state) {
  return state.total == 0 ? 100 : static_cast<int>(100 * state.done / state.total);
}

// The first pieces include one-off work, such as compiling kernels, and say little of the others.
constexpr std::size_t kEnoughForAnEstimate = 10;

/// ", 12.3/s, 0:03 left" with the given separator; empty before there is a rate.
std::string rate_text(const ProgressState& state, const std::string& separator) {
  if (state.done == 0 || state.elapsed_s <= 0.0) return {};
  const double rate = static_cast<double>(state.done) / state.elapsed_s;
  std::string result = separator + fmt::format("{:.{}f}/s", rate, rate < 10.0 ? 2 : 1);
  if (state.total == kUnknownTotal) {
    result += separator + format_duration(state.elapsed_s);
  } else if (state.done < state.total) {
    const double left_s = static_cast<double>(state.total - state.done) / rate;
    result += state.done < kEnoughForAnEstimate ? std::string()
                                                : separator + format_duration(left_s) + " left";
  } else {
    result += separator + format_duration(state.elapsed_s);
  }
  return result;
}

std::string failed_text(const ProgressState& state, const std::string& separator) {
  return state.failed == 0 ? std::string() : separator + std::to_string(state.failed) + " failed";
}

std::string count_text(const ProgressState& state) {
  if (state.total == kUnknownTotal) {
    return std::to_string(state.done) + " " + state.unit;
  }
  return std::to_string(state.done) + "/" + std::to_string(state.total) + " " + state.unit;
}

std::size_t tenth_of(const ProgressState& state) {
  return state.total == 0 ? 10 : 10 * state.done / state.total;
}

std::size_t terminal_columns() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

}  // namespace

std::string format_duration(double seconds) {
  const auto whole = std::llround(std::max(seconds, 0.0));
  return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                       : fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string format_bar(const std::string& label, const ProgressState& state, std::size_t columns) {
  if (state.total == kUnknownTotal) {
    return format_line(label, state).substr(0, columns);
  }
  constexpr std::size_t kLongestBar = 40;
  constexpr std::size_t kShortestBar = 5;
  const std::string share = fmt::format("{:3} %", percent(state));
  const std::string numbers = std::string(share) + "  " + count_text(state) +
                              failed_text(state, "  ") + rate_text(state, "  ");
  const std::size_t fixed = label.size() + numbers.size() + 4;  // " [", "] "
  if (columns < fixed + kShortestBar) {
    return (label + " " + numbers).substr(0, columns);
  }

  const std::size_t length = std::min(kLongestBar, columns - fixed);
  const std::size_t filled = state.total == 0 ? length : length * state.done / state.total;
  std::string bar(filled, '=');
  if (filled < length) {
    bar += '>';
  }
  bar.resize(length, ' ');
  return label + " [" + bar + "] " + numbers;
}

std::string format_line(const std::string& label, const ProgressState& state) {
  if (state.total == kUnknownTotal) {
    return label + " " + count_text(state) + failed_text(state, ", ") + rate_text(state, ", ");
  }
  return label + " " + count_text(state) + " (" + std::to_string(percent(state)) + " %)" +
         failed_text(state, ", ") + rate_text(state, ", ");
}

ProgressStyle progress_style_of_stderr() {
  const char* terminal = std::getenv("TERM");
  const bool can_redraw = terminal != nullptr && std::string_view(terminal) != "dumb";
  return isatty(STDERR_FILENO) != 0 && can_redraw ? ProgressStyle::bar : ProgressStyle::lines;
}

Progress::Progress(std::ostream& stream, ProgressStyle style, std::string label, std::size_t total,
                   Clock::time_point start, std::string unit)
    : stream_(stream),
      style_(style),
      label_(std::move(label)),
      start_(start),
      drawn_at_(start),
      line_at_(start),
      state_{.done = 0, .total = total, .failed = 0, .elapsed_s = 0.0, .unit = std::move(unit)} {}

void Progress::update(std::size_t done, std::size_t failed, Clock::time_point now) {
  state_.done = done;
  state_.failed = failed;
  state_.elapsed_s = std::chrono::duration<double>(now - start_).count();
  const bool last = done >= state_.total;
  if (style_ == ProgressStyle::bar && (last || !bar_visible_ || now - drawn_at_ >= kRedrawEvery)) {
    draw_bar();
    drawn_at_ = now;
  }
  if (style_ != ProgressStyle::none && line_is_due(now)) {
    const std::string line = format_line(label_, state_);
    if (style_ == ProgressStyle::lines) {
      stream_ << line << std::endl;
    } else {
      log_line(stream_, line);
    }
    line_tenth_ = tenth_of(state_);
    line_at_ = now;
  }
}

bool Progress::line_is_due(Clock::time_point now) const {
  const auto since = now - line_at_;
  return state_.done >= state_.total || since >= kLineEvery ||
         (tenth_of(state_) > line_tenth_ && since >= kLineNotBefore);
}

void Progress::note(const std::string& message) {
  if (bar_visible_) {
    stream_ << "\r\x1b[K";
  }
  stream_ << message << std::endl;
  if (bar_visible_) {
    draw_bar();
  }
}

void Progress::finish() {
  if (!bar_visible_) {
    return;
  }
  draw_bar();
  stream_ << std::endl;
  bar_visible_ = false;
}

void Progress::draw_bar() {
  // One column is left free: some terminals wrap when the last one is written.
  stream_ << '\r' << format_bar(label_, state_, terminal_columns() - 1) << "\x1b[K" << std::flush;
  bar_visible_ = true;
}

}  // namespace adit
