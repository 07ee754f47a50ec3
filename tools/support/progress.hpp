// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far a long piece of work is: a bar that redraws itself on a terminal, plain lines elsewhere.
#pragma once

#include <chrono>
#include <cstddef>
#include <iosfwd>
#include <string>

namespace adit {

/// Of work whose end nobody knows: it has no percentage.
inline constexpr std::size_t kUnknownTotal = std::size_t{1} << 48U;

/// How far the work is.
struct ProgressState {
  std::size_t done = 0;
  std::size_t total = 0;
  std::size_t failed = 0;  ///< number among those done
  double elapsed_s = 0.0;
  std::string unit = "sweeps";  ///< what is counted
};

/// "1:02:03", "2:03" or "0:03".
std::string format_duration(double seconds);

/// "map [=====>      ]  45 %  27/60 sweeps  12.3/s  0:03 left", fitted to `columns` by the bar's
/// length.
std::string format_bar(const std::string& label, const ProgressState& state, std::size_t columns);

/// "map 27/60 sweeps (45 %), 12.3/s, 0:03 left".
std::string format_line(const std::string& label, const ProgressState& state);

/// Where progress goes.
enum class ProgressStyle {
  none,
  bar,    ///< one line, redrawn in place
  lines,  ///< a line every 10 % or five seconds, whichever comes first, but not more often than
          ///< once a second
};

/// `bar` where the standard error stream is a terminal that can redraw, `lines` elsewhere.
ProgressStyle progress_style_of_stderr();

/// Reports on a stream, and beside a bar in lines to the log of what is said there, if there is
/// one. Times are given by the caller's steady clock, so that it can be tested.
class Progress {
 public:
  using Clock = std::chrono::steady_clock;

  Progress(std::ostream& stream, ProgressStyle style, std::string label, std::size_t total,
           Clock::time_point start = Clock::now(), std::string unit = "sweeps");

  /// `done` pieces are finished, `failed` of them without success.
  void update(std::size_t done, std::size_t failed, Clock::time_point now = Clock::now());

  /// For work whose size is known only once it has started.
  void set_total(std::size_t total) { state_.total = total; }

  /// Says something that stays, above the bar where there is one.
  void note(const std::string& message);

  /// Leaves the last state on the screen. Nothing may be updated after it.
  void finish();

 private:
  void draw_bar();
  bool line_is_due(Clock::time_point now) const;

  std::ostream& stream_;
  ProgressStyle style_;
  std::string label_;
  Clock::time_point start_;
  Clock::time_point drawn_at_;  ///< of the bar
  Clock::time_point line_at_;
  std::size_t line_tenth_ = 0;
  bool bar_visible_ = false;
  ProgressState state_;
};

}  // namespace adit
