// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/ply_header.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <utility>

#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kLongestPlyHeader = std::size_t{1} << 20U;

std::optional<ScalarType> scalar_type(std::string_view name) {
  struct Name {
    std::string_view text;
    ScalarType type;
  };
  // The format's own names, those with widths, and those of C and of other programs.
  static constexpr std::array<Name, 31> kNames = {{
      {"bool", ScalarType::u8},     {"boolean", ScalarType::u8},   {"byte", ScalarType::i8},
      {"ubyte", ScalarType::u8},    {"schar", ScalarType::i8},     {"int8_t", ScalarType::i8},
      {"uint8_t", ScalarType::u8},  {"int16_t", ScalarType::i16},  {"uint16_t", ScalarType::u16},
      {"int32_t", ScalarType::i32}, {"uint32_t", ScalarType::u32}, {"char", ScalarType::i8},
      {"int8", ScalarType::i8},     {"uchar", ScalarType::u8},     {"uint8", ScalarType::u8},
      {"short", ScalarType::i16},   {"int16", ScalarType::i16},    {"ushort", ScalarType::u16},
      {"uint16", ScalarType::u16},  {"int", ScalarType::i32},      {"int32", ScalarType::i32},
      {"uint", ScalarType::u32},    {"uint32", ScalarType::u32},   {"float", ScalarType::f32},
      {"float32", ScalarType::f32}, {"double", ScalarType::f64},   {"float64", ScalarType::f64},
      {"long", ScalarType::i64},    {"int64", ScalarType::i64},    {"ulong", ScalarType::u64},
      {"uint64", ScalarType::u64},
  }};
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto* const found =
      std::find_if(kNames.begin(), kNames.end(), [&](const Name& n) { return n.text == lower; });
  return found == kNames.end() ? std::nullopt : std::optional(found->type);
}

class PlyHeaderParser {
 public:
  PlyHeaderParser(const std::filesystem::path& file, std::string_view content)
      : file_(file), lines_(content.substr(0, kLongestPlyHeader)) {}

  PlyHeader parse() {
    const std::optional<std::string_view> magic = lines_.next();
    if (!magic || split_words(*magic) != std::vector<std::string_view>{"ply"}) {
      fail("it does not begin with the line 'ply'");
    }
    while (const std::optional<std::string_view> line = lines_.next()) {
      const std::vector<std::string_view> words = split_words(*line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") {
        continue;
      }
      if (words[0] == "end_header") {
        if (!format_seen_) {
          fail("the header ends without a 'format' line");
        }
        header_.bytes = lines_.offset();
        header_.lines = lines_.number();
        return std::move(header_);
      }
      if (words[0] == "format") {
        parse_format(words);
      } else if (words[0] == "element") {
        parse_element(words);
      } else if (words[0] == "property") {
        parse_property(words);
      } else {
        fail("expected format, element, property, comment or end_header, found " +
             in_quotes(*line));
      }
    }
    fail("the header has no 'end_header' line");
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw InputError(file_, Place::line(std::max<uint64_t>(lines_.number(), 1)), found,
                     "Write the file again with a program that keeps to the PLY format 1.0");
  }

  void parse_format(const std::vector<std::string_view>& words) {
    if (format_seen_ || words.size() != 3 || words[2] != "1.0") {
      fail("expected one line 'format ascii|binary_little_endian|binary_big_endian 1.0'");
    }
    format_seen_ = true;
    if (words[1] == "ascii") {
      header_.format = PlyFormat::ascii;
    } else if (words[1] == "binary_little_endian") {
      header_.format = PlyFormat::little_endian;
    } else if (words[1] == "binary_big_endian") {
      header_.format = PlyFormat::big_endian;
    } else {
      fail("the format is " + in_quotes(words[1]) +
           ", expected ascii, binary_little_endian or binary_big_endian");
    }
  }

  void parse_element(const std::vector<std::string_view>& words) {
    const std::optional<uint64_t> count =
        words.size() == 3 ? parse_unsigned(words[2]) : std::nullopt;
    if (!count) {
      fail("expected 'element NAME COUNT'");
    }
    header_.elements.push_back({std::string(words[1]), *count, {}});
  }

  void parse_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) {
      fail("a property before the first element");
    }
    PlyProperty property;
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) {
      fail("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    }
    property.name = std::string(words.back());
    property.type = require_type(words[words.size() - 2]);
    if (list) {
      property.list_count = require_type(words[2]);
      if (*property.list_count == ScalarType::f32 || *property.list_count == ScalarType::f64) {
        fail("the length of a list is " + in_quotes(words[2]) + ", expected an integer type");
      }
    }
    header_.elements.back().properties.push_back(std::move(property));
  }

  ScalarType require_type(std::string_view name) const {
    const std::optional<ScalarType> type = scalar_type(name);
    if (!type) {
      fail("the type " + in_quotes(name) + " is unknown");
    }
    return *type;
  }

  const std::filesystem::path& file_;
  LineReader lines_;
  PlyHeader header_;
  bool format_seen_ = false;
};

}  // namespace

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& p) { return p.list_count.has_value(); });
}

std::size_t PlyElement::smallest_record() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += size_of(property.list_count.value_or(property.type));
  }
  return bytes;
}

PlyHeader parse_ply_header(const std::filesystem::path& file, std::string_view content) {
  return PlyHeaderParser(file, content).parse();
}

}  // namespace adit
