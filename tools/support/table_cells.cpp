// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/table_cells.hpp"

#include <algorithm>
#include <cctype>

#include "adit/tools/support/input_file.hpp"

namespace adit {

std::string_view trimmed_cell(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '#'; };
  while (!text.empty() && is_blank(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_blank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

char separator_of(std::string_view line) {
  char best = ' ';
  std::ptrdiff_t most = 0;
  for (const char candidate : {',', ';', '\t'}) {
    if (const std::ptrdiff_t found = std::ranges::count(line, candidate); found > most) {
      most = found;
      best = candidate;
    }
  }
  return best;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  if (separator == ' ') {
    // A unit in brackets belongs to the name before it, also with blanks in it.
    bool open = false;
    for (const std::string_view word : split_words(trimmed_cell(line))) {
      open = open || (!cells.empty() && (word.front() == '[' || word.front() == '('));
      if (open) {
        const char* const begin = cells.back().data();
        cells.back() = {begin, static_cast<std::size_t>(word.data() + word.size() - begin)};
        open = word.back() != ']' && word.back() != ')';
      } else {
        cells.push_back(word);
      }
    }
    return cells;
  }
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    cells.push_back(trimmed_cell(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

std::string plain_column_name(std::string_view name) {
  std::string plain;
  for (const char c : name.substr(0, name.find_first_of("[("))) {
    const auto code = static_cast<unsigned char>(c);
    if (std::isalnum(code) != 0) {
      plain += static_cast<char>(std::tolower(code));
    }
  }
  return plain;
}

std::string_view column_unit(std::string_view name) {
  const std::size_t open = name.find_first_of("[(");
  if (open == name.npos) {
    return {};
  }
  const std::size_t close = name.find(name[open] == '[' ? ']' : ')', open);
  return trimmed_cell(name.substr(open + 1, close == name.npos ? close : close - open - 1));
}

std::size_t find_column(const std::vector<std::string_view>& names, const TableColumn& wanted) {
  const auto found = std::ranges::find_if(names, [&](std::string_view name) {
    return std::ranges::count(wanted.names, plain_column_name(name)) > 0;
  });
  return static_cast<std::size_t>(found - names.begin());
}

const std::array<TableColumn, 8>& pose_columns() {
  static const std::array<TableColumn, 8> kColumns = {
      {{"a time",
        {"stamps", "ts", "timestamp", "timestampns", "timestamps", "time", "times", "timens", "t",
         "stamp"}},
       {"x", {"xm", "prsrx", "px", "tx", "x", "positionx", "posx"}},
       {"y", {"ym", "prsry", "py", "ty", "y", "positiony", "posy"}},
       {"z", {"zm", "prsrz", "pz", "tz", "z", "positionz", "posz"}},
       {"qx", {"qx", "qrsx", "orientationx"}},
       {"qy", {"qy", "qrsy", "orientationy"}},
       {"qz", {"qz", "qrsz", "orientationz"}},
       {"qw", {"qw", "qrsw", "orientationw"}}}};
  return kColumns;
}

}  // namespace adit
