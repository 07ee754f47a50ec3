// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/line_painter.hpp"

#include <string>

#include <gtest/gtest.h>

namespace adit {
namespace {

std::string painted_at_once(LinePainter::OpeningOf opening_of, const std::string& text) {
  LinePainter painter(opening_of);
  std::string shown = painter.take(text);
  return shown + painter.rest();
}

std::string painted_by_letters(LinePainter::OpeningOf opening_of, const std::string& text) {
  LinePainter painter(opening_of);
  std::string shown;
  for (const char c : text) {
    shown += painter.take({&c, 1});
  }
  return shown + painter.rest();
}

/// However the text is cut.
void expect_painted(LinePainter::OpeningOf opening_of, const std::string& text,
                    const std::string& expected) {
  EXPECT_EQ(painted_at_once(opening_of, text), expected);
  EXPECT_EQ(painted_by_letters(opening_of, text), expected);
}

TEST(LinePainter, MessagesHaveTheirKindInColor) {
  expect_painted(message_opening, "note: no GPU was found\n",
                 painted("note:", Tone::note) + " no GPU was found\n");
  expect_painted(message_opening, "adit run: drive.mcap: cannot be read\n",
                 painted("adit run:", Tone::error) + " drive.mcap: cannot be read\n");
  expect_painted(
      message_opening, "adit bench slam: x\nadit: y\n",
      painted("adit bench slam:", Tone::error) + " x\n" + painted("adit:", Tone::error) + " y\n");
  expect_painted(message_opening, "adit run: warning: left out\n",
                 painted("adit run: warning:", Tone::warning) + " left out\n");
  expect_painted(message_opening, "adit run: we", painted("adit run:", Tone::error) + " we");
  expect_painted(message_opening, "adit run:\n", painted("adit run:", Tone::error) + "\n");
}

TEST(LinePainter, OtherLinesStayAsTheyAre) {
  for (const char* text :
       {"mapping 27/60 sweeps (45 %)\n", "notes are none\n", "adit", "adit run\n", "adit 0.1.0\n",
        "adit run -o out: x\n", " note: indented\n", "\n\n", "a note: within\n",
        "Run `adit run --help`.\n", "n\n", "no", "war\n"}) {
    expect_painted(message_opening, text, text);
  }
  for (const char* text :
       {"{\n  \"verdict\": {\n    \"state\": \"lost\"\n", "verdict\n", "verdict  usable\n",
        "verdict  ", "mapped   lost\n", "re", "note: x\n"}) {
    expect_painted(report_opening, text, text);
  }
}

TEST(LinePainter, VerdictsHaveTheColorOfWhatTheySay) {
  expect_painted(
      report_opening, "sweeps   3\nverdict  reliable: no sweep is in doubt\n",
      "sweeps   3\nverdict  " + painted("reliable", Tone::good) + ": no sweep is in doubt\n");
  expect_painted(report_opening, "verdict      doubtful\n",
                 "verdict      " + painted("doubtful", Tone::warning) + "\n");
  expect_painted(report_opening, "verdict  lost", "verdict  " + painted("lost", Tone::error));
}

TEST(LinePainter, WhatATerminalDrawsOverGoesThrough) {
  expect_painted(
      message_opening, "\rmap [=> ]\x1b[K\r\x1b[Knote: x\n\rmap [==>]\x1b[K\n",
      "\rmap [=> ]\x1b[K\r\x1b[K" + painted("note:", Tone::note) + " x\n\rmap [==>]\x1b[K\n");
  expect_painted(message_opening, "no\rwar\x1b[Kx", "no\rwar\x1b[Kx");
}

TEST(LinePainter, WhatIsDecidedIsShownAtOnce) {
  LinePainter painter(message_opening);
  EXPECT_EQ(painter.take("mapping"), "mapping");
  EXPECT_EQ(painter.take("\nnot"), "\n");
  EXPECT_EQ(painter.take("e:"), painted("note:", Tone::note));
  EXPECT_EQ(painter.rest(), "");
}

}  // namespace
}  // namespace adit
