// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/sweep_times.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool all_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_digit);
}

std::optional<int> parse_digits(std::string_view text, std::size_t width) {
  if (text.size() != width || !all_digits(text)) {
    return std::nullopt;
  }
  return static_cast<int>(*parse_unsigned(text));
}

/// "2011-09-26" and "13:02:25.594360375", as UTC.
std::optional<Nanoseconds> parse_date_time(std::string_view date, std::string_view time) {
  if (date.size() != 10 || date[4] != '-' || date[7] != '-' || time.size() < 8 || time[2] != ':' ||
      time[5] != ':') {
    return std::nullopt;
  }
  const std::optional<int> year = parse_digits(date.substr(0, 4), 4);
  const std::optional<int> month = parse_digits(date.substr(5, 2), 2);
  const std::optional<int> day = parse_digits(date.substr(8, 2), 2);
  const std::optional<int> hour = parse_digits(time.substr(0, 2), 2);
  const std::optional<int> minute = parse_digits(time.substr(3, 2), 2);
  const std::optional<Nanoseconds> second = parse_seconds(time.substr(6));
  if (!year || !month || !day || !hour || !minute || !second || !is_digit(time[6])) {
    return std::nullopt;
  }
  const std::chrono::year_month_day calendar(std::chrono::year(*year),
                                             std::chrono::month(static_cast<unsigned>(*month)),
                                             std::chrono::day(static_cast<unsigned>(*day)));
  if (!calendar.ok() || *hour > 23 || *minute > 59 || *second >= std::chrono::seconds(61)) {
    return std::nullopt;
  }
  // 64 bits of nanoseconds reach from 1677 to 2262.
  if (*year < 1700 || *year > 2200) {
    return std::nullopt;
  }
  return std::chrono::sys_days(calendar).time_since_epoch() + std::chrono::hours(*hour) +
         std::chrono::minutes(*minute) + *second;
}

}  // namespace

std::vector<Nanoseconds> read_times(const std::filesystem::path& file, TimesOrder order) {
  const std::string text = read_text_file(file);
  std::vector<Nanoseconds> times;
  std::optional<uint64_t> blank;
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    std::array<std::string_view, 2> words;
    const std::size_t count = split_words(*line, words);
    if (count == 0) {
      blank = blank.value_or(lines.number());
      continue;
    }
    const std::optional<Nanoseconds> time = count == 1   ? parse_seconds(words[0])
                                            : count == 2 ? parse_date_time(words[0], words[1])
                                                         : std::nullopt;
    if (blank || !time) {
      throw InputError(
          file, Place::line(blank.value_or(lines.number())),
          blank ? "a blank line between the times" : "expected one time, found " + in_quotes(*line),
          "Each line holds one time, in seconds or as 2011-09-26 13:02:25.594360375");
    }
    if (order == TimesOrder::increasing && !times.empty() && *time <= times.back()) {
      throw InputError(file, Place::line(lines.number()),
                       std::string(*time == times.back() ? "the time is the same as"
                                                         : "the time goes back from") +
                           " that of the line before: " + in_quotes(*line),
                       "Times must increase from sweep to sweep; correct the line, or delete it "
                       "together with its sweep");
    }
    times.push_back(*time);
  }
  return times;
}

void require_matching_times(const std::filesystem::path& file, std::size_t times,
                            std::size_t needed, const std::string& things) {
  if (times != needed) {
    throw InputError(
        file, Place::line(times + (times < needed ? 1 : 0)),
        "it holds " + std::to_string(times) + " times for " + std::to_string(needed) + " " + things,
        times < needed ? "Add the missing times, or delete what has none"
                       : "Delete the times of what is missing, or bring the missing files back");
  }
}

std::optional<Nanoseconds> time_from_name(std::string_view stem) {
  // The stem's last number, with at most one separator inside.
  std::size_t begin = stem.size();
  std::size_t separator = std::string_view::npos;
  while (begin > 0) {
    const char c = stem[begin - 1];
    const bool separates = (c == '.' || c == '_') && separator == std::string_view::npos &&
                           begin > 1 && begin < stem.size() && is_digit(stem[begin - 2]);
    if (!is_digit(c) && !separates) {
      break;
    }
    --begin;
    separator = separates ? begin : separator;
  }
  if (begin > 0 && stem[begin - 1] == '-') {
    return std::nullopt;
  }
  const std::string_view number = stem.substr(begin);
  if (separator != std::string_view::npos) {
    const std::string_view seconds = stem.substr(begin, separator - begin);
    const std::string_view fraction = stem.substr(separator + 1);
    if (stem[separator] == '.') {
      return parse_seconds(number);
    }
    if (seconds.size() == 10 && fraction.size() == 9) {
      return parse_seconds(std::string(seconds) + "." + std::string(fraction));
    }
    return all_digits(fraction) ? time_from_name(fraction) : std::nullopt;
  }
  const std::optional<uint64_t> digits = parse_unsigned(number);
  if (!digits || *digits > 9'200'000'000'000'000'000U || number.front() == '0') {
    return std::nullopt;
  }
  if (number.size() == 19) {
    return Nanoseconds(static_cast<int64_t>(*digits));
  }
  if (number.size() == 16) {
    return std::chrono::microseconds(static_cast<int64_t>(*digits));
  }
  return std::nullopt;
}

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) {
        return a[i] < b[j];
      }
      ++i;
      ++j;
      continue;
    }
    const auto take_number = [](std::string_view text, std::size_t& at) {
      const std::size_t begin = at;
      while (at < text.size() && is_digit(text[at])) {
        ++at;
      }
      std::string_view digits = text.substr(begin, at - begin);
      digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
      return digits;
    };
    const std::string_view first = take_number(a, i);
    const std::string_view second = take_number(b, j);
    if (first.size() != second.size()) {
      return first.size() < second.size();
    }
    if (first != second) {
      return first < second;
    }
  }
  if (a.size() - i != b.size() - j) {
    return a.size() - i < b.size() - j;
  }
  return a < b;
}

}  // namespace adit
