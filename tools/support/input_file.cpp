// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/input_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <system_error>
#include <utility>

namespace adit {
namespace {

constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 31U;
constexpr int64_t kNanosecondsPerSecond = 1'000'000'000;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

}  // namespace

InputFile::InputFile(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path_, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw InputError(path_, {}, "there is no such file", "Check the path");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(path_, {},
                     error ? "cannot be looked at: " + error.message() : "is not a regular file",
                     "Give a file that can be read");
  }
  const std::uintmax_t size = std::filesystem::file_size(path_, error);
  if (error) {
    throw InputError(path_, {}, "its size cannot be told: " + error.message(), "Check the disk");
  }
  if (size > kLargestFile) {
    throw InputError(path_, {},
                     "it holds " + std::to_string(size) +
                         " bytes, more than the 2 GiB that a single file may have here",
                     "Check that it is the right file");
  }
  size_ = static_cast<std::size_t>(size);
  file_.reset(std::fopen(path_.c_str(), "rb"));
  if (!file_) {
    throw InputError(path_, {}, std::string("cannot be opened: ") + std::strerror(errno),
                     "Check the permissions");
  }
  // Reads are few and large: straight into the caller's memory.
  static_cast<void>(std::setvbuf(file_.get(), nullptr, _IONBF, 0));
}

void InputFile::read(void* into, std::size_t bytes) {
  errno = 0;
  const std::size_t got = bytes == 0 ? 0 : std::fread(into, 1, bytes, file_.get());
  if (got == bytes) {
    return;
  }
  if (std::ferror(file_.get()) != 0) {
    throw InputError(path_, {}, std::string("cannot be read: ") + std::strerror(errno),
                     "Check the disk");
  }
  throw InputError(path_, {}, "ended while it was read; it has become shorter",
                   "Wait until it is written");
}

std::string read_whole_file(const std::filesystem::path& path) {
  InputFile file(path);
  std::string text(file.size(), '\0');
  file.read(text.data(), text.size());
  return text;
}

std::size_t start_of_text(const std::filesystem::path& path, std::string_view head) {
  constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";
  if (head.starts_with(kUtf8Mark)) {
    return kUtf8Mark.size();
  }
  const auto is_letter = [&](std::size_t i) { return head[i] >= ' ' && head[i] <= '~'; };
  // Letters with zeros between them: the same text without a mark.
  const bool zeros_between =
      head.size() >= 4 && ((is_letter(0) && head[1] == '\0' && is_letter(2) && head[3] == '\0') ||
                           (head[0] == '\0' && is_letter(1) && head[2] == '\0' && is_letter(3)));
  constexpr std::string_view kUtf32Mark("\0\0\xfe\xff", 4);
  if (head.starts_with("\xff\xfe") || head.starts_with("\xfe\xff") ||
      head.starts_with(kUtf32Mark) || zeros_between) {
    throw InputError(path, Place::byte(0), "it is text in UTF-16 or UTF-32, and adit reads UTF-8",
                     "Save it as UTF-8, for example with `iconv -f UTF-16 -t UTF-8`");
  }
  return 0;
}

std::string read_text_file(const std::filesystem::path& path) {
  std::string text = read_whole_file(path);
  text.erase(0, start_of_text(path, text));
  return text;
}

std::ifstream open_text_file(const std::filesystem::path& path) {
  std::error_code ignored;
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path, ignored)) {
    throw InputError(path, {}, "it cannot be read", "Check the path and its permissions");
  }
  std::array<char, 4> head{};
  stream.read(head.data(), head.size());
  const auto bytes = static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0));
  const std::size_t start = start_of_text(path, std::string_view(head.data(), bytes));
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(start));
  return stream;
}

std::optional<std::string_view> LineReader::next() {
  if (offset_ >= text_.size()) {
    return std::nullopt;
  }
  const std::size_t end = std::min(text_.find('\n', offset_), text_.size());
  std::string_view line = text_.substr(offset_, end - offset_);
  offset_ = std::min(end + 1, text_.size());
  ++number_;
  if (!line.empty() && line.back() == '\r') {
    line.remove_suffix(1);
  }
  return line;
}

std::size_t split_words(std::string_view line, std::span<std::string_view> words) {
  std::size_t count = 0;
  std::size_t i = 0;
  while (true) {
    while (i < line.size() && is_blank(line[i])) {
      ++i;
    }
    if (i == line.size()) {
      return count;
    }
    const std::size_t begin = i;
    while (i < line.size() && !is_blank(line[i])) {
      ++i;
    }
    if (count < words.size()) {
      words[count] = line.substr(begin, i - begin);
    }
    ++count;
  }
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words(split_words(line, {}));
  split_words(line, words);
  return words;
}

std::string_view without_comment(std::string_view line) {
  return line.substr(0, line.find('#'));
}

std::optional<double> parse_double(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') {
    word.remove_prefix(1);
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) {
    return std::nullopt;
  }
  if (error == std::errc::result_out_of_range) {
    // Too small for a double is zero; too large is no number.
    const std::string copy(word);
    const bool tiny = copy.find("e-") != std::string::npos || copy.find("E-") != std::string::npos;
    return tiny ? std::optional<double>(0.0) : std::nullopt;
  }
  return error == std::errc() ? std::optional<double>(value) : std::nullopt;
}

std::optional<uint64_t> parse_unsigned(std::string_view word) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) {
    return std::nullopt;
  }
  return value;
}

std::optional<Nanoseconds> to_nanoseconds(double seconds) {
  if (!(std::abs(seconds) < 9.2e9)) {
    return std::nullopt;
  }
  // The whole seconds apart: a product of 1e18 would be rounded to 256 ns.
  const double whole = std::trunc(seconds);
  return Nanoseconds(static_cast<int64_t>(whole) * kNanosecondsPerSecond +
                     std::llround((seconds - whole) * 1e9));
}

std::optional<Nanoseconds> parse_seconds(std::string_view word) {
  const std::optional<double> approximate = parse_double(word);
  if (!approximate) {
    return std::nullopt;
  }
  const std::optional<Nanoseconds> rounded = to_nanoseconds(*approximate);
  std::string_view digits = word;
  const bool negative = digits.front() == '-';
  if (negative || digits.front() == '+') {
    digits.remove_prefix(1);
  }
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const std::string_view whole = digits.substr(0, point);
  const std::string_view fraction =
      point < digits.size() ? digits.substr(point + 1) : std::string_view();
  const bool plain = std::all_of(whole.begin(), whole.end(), is_digit) &&
                     std::all_of(fraction.begin(), fraction.end(), is_digit);
  if (!rounded || !plain) {
    return rounded;
  }
  int64_t nanoseconds = 0;  // cannot overflow: `rounded` fits
  for (const char c : whole) {
    nanoseconds = nanoseconds * 10 + (c - '0');
  }
  nanoseconds *= kNanosecondsPerSecond;
  int64_t unit = kNanosecondsPerSecond / 10;
  for (std::size_t i = 0; i < fraction.size() && i < 9; ++i, unit /= 10) {
    nanoseconds += unit * (fraction[i] - '0');
  }
  if (fraction.size() > 9 && fraction[9] >= '5') {
    ++nanoseconds;
  }
  return Nanoseconds(negative ? -nanoseconds : nanoseconds);
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text = "'";
  for (const char c : word.substr(0, kLongest)) {
    const auto code = static_cast<unsigned char>(c);
    text += code >= 0x20U && code != 0x7fU ? c : '?';
  }
  text += word.size() > kLongest ? "...'" : "'";
  return text;
}

}  // namespace adit
