// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/nearest_name.hpp"

#include <algorithm>
#include <cctype>

namespace adit {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// Without the dashes of an option: they would make any two options alike.
std::string_view bare(std::string_view name) {
  return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> table((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& {
    return table[i * width + j];
  };
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        at(i, j) = i + j;
        continue;
      }
      const std::size_t replaced = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({replaced, at(i - 1, j) + 1, at(i, j - 1) + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
      }
    }
  }
  return table.back();
}

std::string suggestion(std::string_view given, const std::vector<std::string>& valid,
                       const std::string& before) {
  if (valid.empty()) return {};
  const auto distance = [&](const std::string& name) {
    return edit_distance(lower(bare(given)), lower(bare(name)));
  };
  const std::string& nearest = *std::ranges::min_element(valid, {}, distance);
  // A word of which less than half survives is no slip of the pen.
  if (2 * distance(nearest) <= std::max(bare(given).size(), bare(nearest).size())) {
    return "The nearest valid name is '" + before + nearest + "'";
  }
  if (valid.size() == 1) {
    return "The only valid name is '" + before + valid.front() + "'";
  }
  std::string list = "Valid are ";
  for (const std::string& name : valid) {
    if (&name != &valid.front()) {
      list += ", ";
    }
    list += before + name;
  }
  return list;
}

}  // namespace adit
