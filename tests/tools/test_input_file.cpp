// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/input_file.hpp"

#include <array>
#include <clocale>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

TEST(InputFile, NumbersFillTheWholeWord) {
  EXPECT_EQ(parse_double("1.5"), 1.5);
  EXPECT_EQ(parse_double("+2e3"), 2000.0);
  EXPECT_EQ(parse_double("-0.25"), -0.25);
  EXPECT_EQ(parse_double(".5"), 0.5);
  for (const char* word : {"", "+", "-", "+-1", "1.5x", "1,5", "0x10", "1e", "--1", " 1", "1 "}) {
    EXPECT_FALSE(parse_double(word)) << word;
  }
}

TEST(InputFile, NumbersAtTheEndsOfTheRange) {
  EXPECT_TRUE(std::isnan(parse_double("nan").value()));
  EXPECT_TRUE(std::isinf(parse_double("-inf").value()));
  EXPECT_EQ(parse_double("1e-400"), 0.0);
  EXPECT_FALSE(parse_double("1e400"));
}

TEST(InputFile, NumbersDoNotDependOnTheLocale) {
  const char* const previous = std::setlocale(LC_NUMERIC, nullptr);
  const std::string saved = previous != nullptr ? previous : "C";
  const bool german = std::setlocale(LC_NUMERIC, "de_DE.UTF-8") != nullptr;
  EXPECT_EQ(parse_double("1.5"), 1.5)
      << (german ? "under de_DE" : "under C; de_DE is not installed");
  std::setlocale(LC_NUMERIC, saved.c_str());
}

TEST(InputFile, SecondsAreExactToTheNanosecond) {
  EXPECT_EQ(parse_seconds("1623370000.123456789"), Nanoseconds(1623370000123456789));
  EXPECT_EQ(parse_seconds("1623370000.1234567894"), Nanoseconds(1623370000123456789));
  EXPECT_EQ(parse_seconds("1623370000.1234567896"), Nanoseconds(1623370000123456790));
  EXPECT_EQ(parse_seconds("-0.000000001"), Nanoseconds(-1));
  EXPECT_EQ(parse_seconds("0.9999999999"), Nanoseconds(1000000000));
  EXPECT_EQ(parse_seconds("+7"), Nanoseconds(7000000000));
  EXPECT_EQ(parse_seconds("1.037359e-01"), Nanoseconds(103735900));
}

TEST(InputFile, SecondsThatDoNotFitAreNoTime) {
  for (const char* word : {"1e10", "9300000000", "-9300000000", "nan", "inf", "1:00", ""}) {
    EXPECT_FALSE(parse_seconds(word)) << word;
  }
}

TEST(InputFile, UnsignedNumbersDoNotWrap) {
  EXPECT_EQ(parse_unsigned("18446744073709551615"), std::numeric_limits<uint64_t>::max());
  for (const char* word : {"18446744073709551616", "-1", "+1", "1.0", ""}) {
    EXPECT_FALSE(parse_unsigned(word)) << word;
  }
}

TEST(InputFile, LinesEndWithLfCrlfOrTheText) {
  LineReader lines("one\r\n\ntwo\nthree");
  EXPECT_EQ(lines.next(), "one");
  EXPECT_EQ(lines.next(), "");
  EXPECT_EQ(lines.next(), "two");
  EXPECT_EQ(lines.number(), 3U);
  EXPECT_EQ(lines.rest(), "three");
  EXPECT_EQ(lines.next(), "three");
  EXPECT_EQ(lines.number(), 4U);
  EXPECT_FALSE(lines.next());
}

TEST(InputFile, WordsBeyondTheRoomAreCountedNotStored) {
  std::array<std::string_view, 2> words;
  EXPECT_EQ(split_words("  a\tbb  ccc ", words), 3U);
  EXPECT_EQ(words[1], "bb");
  EXPECT_EQ(split_words(" \t ", words), 0U);
}

TEST(InputFile, WordsInMessagesAreShortAndPrintable) {
  EXPECT_EQ(in_quotes("a\nb\x01"), "'a?b?'");
  EXPECT_EQ(in_quotes(std::string(100, 'x')).size(), 45U);
}

TEST(InputFile, MissingFileAndFolderAreNamed) {
  const test::TemporaryFolder folder;
  for (const std::filesystem::path& path : {folder / "missing.bin", folder.path()}) {
    try {
      read_text_file(path);
      FAIL() << "read " << path;
    } catch (const InputError& error) {
      EXPECT_EQ(error.file(), path);
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
    }
  }
}

TEST(InputFile, HugeFileIsRefusedBeforeItIsRead) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("sparse.bin", "x");
  std::filesystem::resize_file(file, std::uintmax_t{5} << 30U);  // sparse: takes no space
  EXPECT_THROW(read_text_file(file), InputError);
}

TEST(InputError, MessageHasFilePlaceFoundAndRemedy) {
  const InputError error("sweeps/7.pcd", Place::line(12), "POINTS is 3", "Write it again");
  EXPECT_STREQ(error.what(), "sweeps/7.pcd, line 12: POINTS is 3. Write it again.");
  EXPECT_EQ(error.place(), "line 12");
  const InputError whole("a.ply", {}, "is empty", "");
  EXPECT_STREQ(whole.what(), "a.ply: is empty.");
}

TEST(InputFile, AByteOrderMarkIsNoText) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("a.txt",
                                 "\xef\xbb\xbf"
                                 "1 2\n");
  EXPECT_EQ(read_text_file(file), "1 2\n");
  EXPECT_EQ(read_whole_file(file).size(), 7U);
  std::string line;
  std::ifstream stream = open_text_file(file);
  std::getline(stream, line);
  EXPECT_EQ(line, "1 2");
  for (const char* text : {"", "1", "12", "123"}) {  // shorter than a mark
    const auto plain = folder.write("b.txt", text);
    EXPECT_EQ(read_text_file(plain), text);
    std::ifstream opened = open_text_file(plain);
    line.clear();
    std::getline(opened, line);
    EXPECT_EQ(line, text);
  }
}

TEST(InputFile, TextInUtf16IsRefusedInWords) {
  const test::TemporaryFolder folder;
  for (const std::string& text : {std::string("\xff\xfe"
                                              "1\0 \0",
                                              6),
                                  std::string("\xfe\xff\0"
                                              "1\0 ",
                                              6),
                                  std::string("1\0 \0"
                                              "2\0",
                                              6),
                                  std::string("\0"
                                              "1\0 \0"
                                              "2",
                                              6),
                                  std::string("\xff\xfe\0\0"
                                              "1\0\0\0",
                                              8),
                                  std::string("\0\0\xfe\xff\0\0\0"
                                              "1",
                                              8)}) {
    const auto file = folder.write("a.txt", text);
    for (const bool stream : {false, true}) {
      try {
        if (stream) {
          open_text_file(file);
        } else {
          read_text_file(file);
        }
        ADD_FAILURE() << text.size();
      } catch (const InputError& error) {
        EXPECT_NE(error.found().find("UTF-16"), std::string::npos);
        EXPECT_NE(error.remedy().find("UTF-8"), std::string::npos);
      }
    }
  }
}

}  // namespace
}  // namespace adit
