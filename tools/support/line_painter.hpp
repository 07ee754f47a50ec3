// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which part of a line of text is coloured: the word at its beginning that says what kind of line
// it is. Text comes in pieces of any size.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "adit/tools/support/color.hpp"

namespace adit {

/// What is known of a line by its beginning.
struct LineOpening {
  bool decided = true;      ///< false: what is still to come decides
  std::size_t plain = 0;    ///< so many bytes stay as they are
  std::size_t colored = 0;  ///< so many after them have the tone; 0: no part of the line has one
  Tone tone = Tone::note;
};

/// Of messages: "note:" and "warning:"; "adit COMMAND:" as an error, or with the "warning:" behind
/// it as a warning. `whole` is false where more of the line may come.
LineOpening message_opening(std::string_view line, bool whole);
/// Of reports: what follows "verdict" as "reliable", "doubtful" or "lost".
LineOpening report_opening(std::string_view line, bool whole);

/// Puts the colours into a text that comes piece by piece. Lines that a terminal draws over
/// (carriage returns, escape sequences) go through as they are.
class LinePainter {
 public:
  using OpeningOf = LineOpening (*)(std::string_view line, bool whole);

  explicit LinePainter(OpeningOf opening_of) : opening_of_(opening_of) {}

  /// What can be shown by now. The beginning of a line is held back until it is decided on.
  std::string take(std::string_view text);
  /// What was held back, when nothing more comes.
  std::string rest();

 private:
  std::string give(bool whole);

  OpeningOf opening_of_;
  std::string held_;
  bool at_start_ = true;
  bool in_escape_ = false;
};

}  // namespace adit
