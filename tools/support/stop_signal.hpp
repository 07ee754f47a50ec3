// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace adit {

/// While it lives, the first SIGINT (Ctrl-C), SIGTERM or SIGHUP (the terminal is closed) is noted
/// instead of ending the process, so that work can end in good order; the second one ends it as
/// usual. A SIGHUP that `nohup` had ignored stays ignored, and a pipe whose reader goes away ends
/// nothing. One at a time.
class StopSignal {
 public:
  /// `hang_up_stops` false: a SIGHUP is counted, and ends nothing.
  explicit StopSignal(bool hang_up_stops = true);
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// The signal's number, 0 while none has come.
  static int received();
  /// How many SIGHUPs were counted; nothing resets it.
  static int hang_ups();

 private:
  using Handler = void (*)(int);
  std::array<Handler, 4> earlier_;
};

}  // namespace adit
