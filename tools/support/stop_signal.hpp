// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace adit {

/// While it lives, the first SIGINT (Ctrl-C) or SIGTERM is noted instead of ending the process, so
/// that work can end in good order; the second one ends it as usual. One at a time.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// The signal's number, 0 while none has come.
  static int received();

 private:
  using Handler = void (*)(int);
  Handler earlier_interrupt_;
  Handler earlier_terminate_;
};

}  // namespace adit
