// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/line_painter.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace adit {
namespace {

constexpr LineOpening kUndecided = {.decided = false};
constexpr LineOpening kPlain = {.decided = true};

/// `text` may still become `word`.
bool may_become(std::string_view text, std::string_view word, bool whole) {
  return !whole && text.size() < word.size() && word.starts_with(text);
}

struct ColoredWord {
  std::string_view word;
  Tone tone;
};

constexpr std::array<ColoredWord, 2> kKinds = {
    {{"note:", Tone::note}, {"warning:", Tone::warning}}};
constexpr std::array<ColoredWord, 3> kVerdicts = {
    {{"reliable", Tone::good}, {"doubtful", Tone::warning}, {"lost", Tone::error}}};

/// The line after `plain` bytes of it begins with one of the words.
template <class Words>
LineOpening one_of_words(std::string_view line, std::size_t plain, const Words& words, bool whole) {
  const std::string_view text = line.substr(plain);
  bool open = false;
  for (const ColoredWord& one : words) {
    if (text.starts_with(one.word)) {
      return {.plain = plain, .colored = one.word.size(), .tone = one.tone};
    }
    open = open || may_become(text, one.word, whole);
  }
  return open ? kUndecided : kPlain;
}

/// "adit run: " and what follows it.
LineOpening complaint(std::string_view line, bool whole) {
  constexpr std::string_view kProgram = "adit";
  if (!line.starts_with(kProgram)) {
    return may_become(line, kProgram, whole) ? kUndecided : kPlain;
  }
  const auto within = [](char c) {
    return c == ' ' || std::islower(static_cast<unsigned char>(c));
  };
  const auto end = static_cast<std::size_t>(std::ranges::find_if_not(line, within) - line.begin());
  if (end == line.size()) {
    return whole ? kPlain : kUndecided;
  }
  if (line[end] != ':') {
    return kPlain;
  }
  const LineOpening error = {.colored = end + 1, .tone = Tone::error};
  constexpr std::string_view kBehind = " warning:";
  const std::string_view behind = line.substr(end + 1);
  if (behind.starts_with(kBehind)) {
    return {.colored = end + 1 + kBehind.size(), .tone = Tone::warning};
  }
  return may_become(behind, kBehind, whole) ? kUndecided : error;
}

}  // namespace

LineOpening message_opening(std::string_view line, bool whole) {
  const LineOpening kind = one_of_words(line, 0, kKinds, whole);
  return kind.decided && kind.colored == 0 ? complaint(line, whole) : kind;
}

LineOpening report_opening(std::string_view line, bool whole) {
  constexpr std::string_view kVerdict = "verdict ";
  if (!line.starts_with(kVerdict)) {
    return may_become(line, kVerdict, whole) ? kUndecided : kPlain;
  }
  const std::size_t word = line.find_first_not_of(' ', kVerdict.size());
  if (word == line.npos) {
    return whole ? kPlain : kUndecided;
  }
  return one_of_words(line, word, kVerdicts, whole);
}

std::string LinePainter::give(bool whole) {
  const LineOpening opening = opening_of_(held_, whole);
  if (!opening.decided) {
    return {};
  }
  const std::string line = std::exchange(held_, {});
  at_start_ = false;
  if (opening.colored == 0) {
    return line;
  }
  return line.substr(0, opening.plain) +
         painted(line.substr(opening.plain, opening.colored), opening.tone) +
         line.substr(opening.plain + opening.colored);
}

std::string LinePainter::take(std::string_view text) {
  std::string shown;
  for (const char c : text) {
    const bool begins_escape = c == '\x1b';
    if (c == '\n' || c == '\r' || begins_escape || in_escape_) {
      shown += rest() + c;
      at_start_ = at_start_ || c == '\n' || c == '\r';
      // "ESC [ 31 m": it ends with a letter
      in_escape_ = begins_escape ||
                   (in_escape_ && std::isalpha(static_cast<unsigned char>(c)) == 0 && c != '\n');
    } else if (at_start_) {
      held_ += c;
      shown += give(false);
    } else {
      shown += c;
    }
  }
  return shown;
}

std::string LinePainter::rest() {
  return held_.empty() ? std::string() : give(true);
}

}  // namespace adit
