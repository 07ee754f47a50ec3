// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/pcd_header.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kLongestHeader = 64 * 1024;
constexpr uint64_t kMostFieldEntries = 4096;          // per field
constexpr uint64_t kMostPoints = uint64_t{1} << 31U;  // files end at 2 GiB

char to_upper(char c) {
  return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
}
char to_lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

constexpr std::string_view kHeaderRemedy =
    "Write the file again with a program that keeps to the PCD format 0.7";

/// One line of the header: the words after the keyword, and where it stood.
struct Entry {
  std::vector<std::string_view> words;
  uint64_t line = 0;
};

class HeaderParser {
 public:
  HeaderParser(const std::filesystem::path& file, std::string_view content)
      : file_(file), content_(content), lines_(content.substr(0, kLongestHeader)) {}

  PcdHeader parse() {
    read_entries();
    PcdHeader header;
    header.bytes = lines_.offset();
    header.lines = lines_.number();
    header.data = data();
    header.fields = fields();
    for (PcdField& field : header.fields) {
      field.offset = header.point_bytes;
      header.point_bytes += field.bytes();
      header.numbers += field.count;
    }
    std::tie(header.points, header.other_points) = points();
    return header;
  }

 private:
  [[noreturn]] void fail(const Place& place, const std::string& found) const {
    throw InputError(file_, place, found, std::string(kHeaderRemedy));
  }

  void read_entries() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      std::vector<std::string_view> words = split_words(*line);
      if (words.empty() || words.front().front() == '#') {
        continue;
      }
      std::string key(words.front());
      std::ranges::transform(key, key.begin(), to_upper);
      static const std::string_view known[] = {"VERSION",   "FIELDS", "COLUMNS", "SIZE",
                                               "TYPE",      "COUNT",  "WIDTH",   "HEIGHT",
                                               "VIEWPOINT", "POINTS", "DATA"};
      bool is_known = false;
      for (const std::string_view candidate : known) {
        is_known = is_known || key == candidate;
      }
      if (!is_known) {
        fail(
            Place::line(lines_.number()),
            "expected an entry of a PCD header (FIELDS, SIZE, TYPE, ...), found " + in_quotes(key));
      }
      words.erase(words.begin());
      const auto [entry, inserted] =
          entries_.emplace(key, Entry{std::move(words), lines_.number()});
      if (!inserted) {
        fail(Place::line(lines_.number()),
             key + " was given before, in line " + std::to_string(entry->second.line));
      }
      if (key == "DATA") {
        return;
      }
    }
    fail({}, content_.size() > kLongestHeader ? "no DATA entry in its first 64 KiB"
                                              : "it ends before the DATA entry of its header");
  }

  const Entry* find(const std::string& key) const {
    const auto found = entries_.find(key);
    return found == entries_.end() ? nullptr : &found->second;
  }

  const Entry& require(const std::string& key) const {
    const Entry* entry = find(key);
    if (entry == nullptr) {
      fail({}, "its header has no " + key + " entry");
    }
    return *entry;
  }

  PcdData data() const {
    const Entry& entry = require("DATA");
    std::string kind(entry.words.size() == 1 ? entry.words[0] : std::string_view());
    std::ranges::transform(kind, kind.begin(), to_lower);
    if (kind == "ascii") {
      return PcdData::ascii;
    }
    if (kind == "binary") {
      return PcdData::binary;
    }
    if (kind == "binary_compressed") {
      return PcdData::binary_compressed;
    }
    fail(Place::line(entry.line),
         "DATA is " + in_quotes(kind) + ", expected ascii, binary or binary_compressed");
  }

  const Entry& require_per_field(const std::string& key, std::size_t fields) const {
    const Entry& entry = require(key);
    if (entry.words.size() != fields) {
      fail(Place::line(entry.line), key + " has " + std::to_string(entry.words.size()) +
                                        " entries for " + std::to_string(fields) + " FIELDS");
    }
    return entry;
  }

  std::vector<PcdField> fields() const {
    const Entry& names = find("FIELDS") != nullptr ? require("FIELDS") : require("COLUMNS");
    const Entry& sizes = require_per_field("SIZE", names.words.size());
    const Entry& types = require_per_field("TYPE", names.words.size());
    const Entry* counts =
        find("COUNT") != nullptr ? &require_per_field("COUNT", names.words.size()) : nullptr;
    std::vector<PcdField> result;
    for (std::size_t i = 0; i < names.words.size(); ++i) {
      PcdField field;
      field.name = std::string(names.words[i]);
      const std::optional<ScalarType> type = scalar_type(types.words[i], sizes.words[i]);
      if (!type) {
        fail(Place::line(types.line),
             "field " + in_quotes(field.name) + " has TYPE " + in_quotes(types.words[i]) +
                 " and SIZE " + in_quotes(sizes.words[i]) +
                 "; numbers are I or U of 1, 2, 4 or 8 bytes, or F of 4 or 8");
      }
      field.type = *type;
      if (counts != nullptr) {
        const std::optional<uint64_t> count = parse_unsigned(counts->words[i]);
        if (!count || *count > kMostFieldEntries) {
          fail(Place::line(counts->line), "field " + in_quotes(field.name) + " has COUNT " +
                                              in_quotes(counts->words[i]) + ", expected 0 to 4096");
        }
        field.count = static_cast<std::size_t>(*count);
      }
      result.push_back(std::move(field));
    }
    return result;
  }

  static std::optional<ScalarType> scalar_type(std::string_view type, std::string_view size) {
    static const std::map<std::pair<std::string_view, std::string_view>, ScalarType> kTypes = {
        {{"I", "1"}, ScalarType::i8},  {{"I", "2"}, ScalarType::i16}, {{"I", "4"}, ScalarType::i32},
        {{"I", "8"}, ScalarType::i64}, {{"U", "1"}, ScalarType::u8},  {{"U", "2"}, ScalarType::u16},
        {{"U", "4"}, ScalarType::u32}, {{"U", "8"}, ScalarType::u64}, {{"F", "4"}, ScalarType::f32},
        {{"F", "8"}, ScalarType::f64}};
    const std::string upper(1, type.size() == 1 ? to_upper(type.front()) : '?');
    const auto found = kTypes.find({upper, size});
    return found == kTypes.end() ? std::nullopt : std::optional(found->second);
  }

  uint64_t number(const std::string& key) const {
    const Entry& entry = require(key);
    const std::optional<uint64_t> value =
        entry.words.size() == 1 ? parse_unsigned(entry.words[0]) : std::nullopt;
    if (!value || *value > kMostPoints) {
      fail(Place::line(entry.line), key + " is " +
                                        in_quotes(entry.words.empty() ? "" : entry.words[0]) +
                                        ", expected one number up to 2^31");
    }
    return *value;
  }

  /// POINTS, and WIDTH x HEIGHT; the same number twice where the header has one of them.
  std::pair<uint64_t, uint64_t> points() const {
    const bool has_points = find("POINTS") != nullptr;
    const bool has_cells = find("WIDTH") != nullptr && find("HEIGHT") != nullptr;
    if (has_points && !has_cells) {
      return {number("POINTS"), number("POINTS")};
    }
    const uint64_t cells = number("WIDTH") * number("HEIGHT");  // each at most 2^31
    if (!has_points && cells > kMostPoints) {
      fail(Place::line(require("WIDTH").line),
           "WIDTH x HEIGHT is " + std::to_string(cells) + " points, more than any file holds here");
    }
    return {has_points ? number("POINTS") : cells, cells};
  }

  const std::filesystem::path& file_;
  std::string_view content_;
  LineReader lines_;
  std::map<std::string, Entry> entries_;
};

}  // namespace

PcdHeader parse_pcd_header(const std::filesystem::path& file, std::string_view content) {
  return HeaderParser(file, content).parse();
}

}  // namespace adit
