// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/log_file.hpp"

#include <algorithm>
#include <chrono>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/message_buffer.hpp"
#include "adit/tools/support/progress.hpp"

namespace adit {
namespace {

using namespace std::chrono_literals;
using std::chrono::system_clock;

constexpr system_clock::time_point kNoon{1'772'366'400'250ms};  // of 1 March 2026, and a quarter
constexpr std::size_t kTimeLength = 25;                         // with the blank behind it

/// The log without its times.
std::vector<std::string> said_in(const std::filesystem::path& file) {
  std::istringstream text(read_text_file(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    lines.push_back(line.substr(std::min(kTimeLength, line.size())));
  }
  return lines;
}

std::string message_of_opening(const std::filesystem::path& file) {
  try {
    LogFile log(file);
  } catch (const OutputError& error) {
    return error.what();
  }
  return {};
}

TEST(LogLines, AreWhatATerminalShowsInTheEnd) {
  LogLines lines;
  EXPECT_EQ(lines.take("note: a\nhalf a "), std::vector<std::string>{"note: a"});
  EXPECT_EQ(lines.take("line\n\n"), std::vector<std::string>{"half a line"});
  EXPECT_EQ(lines.take("\rmap [=> ]\x1b[K\rmap [==>]\x1b[K\r\x1b[Knote: b\n\rmap [===]\x1b[K\n"),
            std::vector<std::string>{"note: b"});
  EXPECT_EQ(lines.take("\x1b[1;38;5;30mnote:\x1b[0m c\n"), std::vector<std::string>{"note: c"});
  EXPECT_TRUE(lines.take("not ended").empty());
  EXPECT_EQ(lines.rest(), "not ended");
}

TEST(LogFile, LinesHaveTheirTimeInUtcAndEarlierOnesStay) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "adit.log";
  EXPECT_EQ(utc_text(kNoon), "2026-03-01T12:00:00.250Z");
  LogFile(file).write("one", kNoon);
  LogFile log(file);
  log.write("two", kNoon + 1s);
  EXPECT_EQ(read_text_file(file), "2026-03-01T12:00:00.250Z one\n2026-03-01T12:00:01.250Z two\n");
  EXPECT_EQ(log.failure(), "");
}

TEST(LogFile, NothingButALogIsWrittenInto) {
  const test::TemporaryFolder folder;
  for (const char* content : {"mine", "{\n  \"adit\": \"0.1.0\", \"status\": \"running\"\n}\n"}) {
    const std::filesystem::path file = folder.write("drive.mcap", content);
    EXPECT_NE(message_of_opening(file).find("something else than a log"), std::string::npos);
    EXPECT_EQ(read_text_file(file), content);
  }
  EXPECT_EQ(message_of_opening(folder.write("empty", "")), "");
}

TEST(LogFile, WhatCannotBeWrittenSaysWhy) {
  const test::TemporaryFolder folder;
  const std::string missing = message_of_opening(folder / "no" / "adit.log");
  EXPECT_NE(missing.find("No such file or directory. Name a file"), std::string::npos) << missing;
  EXPECT_NE(message_of_opening(folder.path()).find("directory"), std::string::npos);
  LogFile full("/dev/full");
  full.write("line");
  EXPECT_NE(full.failure().find("/dev/full: the log is not whole: No space left"),
            std::string::npos)
      << full.failure();
}

TEST(MessageBuffer, TerminalGetsColorsAndTheLogTheText) {
  const test::TemporaryFolder folder;
  LogFile log(folder / "adit.log");
  std::ostringstream terminal;
  {
    MessageBuffer buffer(*terminal.rdbuf());
    buffer.use({.colors = message_opening, .log = &log});
    std::ostream err(&buffer);
    err << "adit "
        << "run"
        << ": " << 3 << " sweeps" << std::endl
        << "note: no end";
  }
  EXPECT_EQ(terminal.str(), painted("adit run:", Tone::error) + " 3 sweeps\n" +
                                painted("note:", Tone::note) + " no end");
  EXPECT_EQ(said_in(folder / "adit.log"),
            (std::vector<std::string>{"adit run: 3 sweeps", "note: no end"}));
}

TEST(MessageBuffer, DetailsAreForTheLogUnlessTheyAreWanted) {
  const test::TemporaryFolder folder;
  LogFile log(folder / "adit.log");
  std::ostringstream terminal;
  say_detail(terminal, "goes nowhere");
  MessageBuffer buffer(*terminal.rdbuf());
  std::ostream err(&buffer);
  say_detail(err, "goes nowhere either");
  buffer.use({.log = &log});
  say_detail(err, "one");
  EXPECT_EQ(terminal.str(), "");
  buffer.use({.log = &log, .details = true});
  say_detail(err, "two");
  EXPECT_EQ(terminal.str(), "note: two\n");
  EXPECT_EQ(said_in(folder / "adit.log"), (std::vector<std::string>{"note: one", "note: two"}));
}

TEST(MessageBuffer, FailureOfItsTargetIsThatOfTheStream) {
  class Full : public std::streambuf {};  // takes nothing
  Full full;
  MessageBuffer buffer(full);
  std::ostream err(&buffer);
  EXPECT_FALSE(err << "text");
}

TEST(MessageBuffer, ProgressIsABarOnTheTerminalAndLinesInTheLog) {
  const test::TemporaryFolder folder;
  LogFile log(folder / "adit.log");
  std::ostringstream terminal;
  MessageBuffer buffer(*terminal.rdbuf());
  buffer.use({.log = &log});
  std::ostream err(&buffer);
  const Progress::Clock::time_point start;
  Progress progress(err, ProgressStyle::bar, "map", 20, start);
  for (std::size_t i = 1; i <= 20; ++i) {
    progress.update(i, 0, start + i * 400ms);  // a line is due each 1.2 s
    if (i == 10) {
      progress.note("note: half of it");
    }
  }
  progress.finish();
  EXPECT_NE(terminal.str().find("[=="), std::string::npos);
  const std::vector<std::string> lines = said_in(folder / "adit.log");
  ASSERT_GE(lines.size(), 5U);
  EXPECT_EQ(lines.front(), "map 3/20 sweeps (15 %), 2.50/s");
  EXPECT_EQ(lines.back(), "map 20/20 sweeps (100 %), 2.50/s, 0:08");
  EXPECT_EQ(std::ranges::count(lines, "note: half of it"), 1);
  for (const std::string& line : lines) {
    EXPECT_EQ(line.find_first_of("[\r\x1b"), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace adit
