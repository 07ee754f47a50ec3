// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>

namespace adit {

/// Ids for people: "0-4, 7", the first ten ranges of them.
inline std::string ranges_of(const std::set<int64_t>& ids) {
  std::string text;
  int ranges = 0;
  for (auto id = ids.begin(); id != ids.end();) {
    if (++ranges > 10) {
      return text + " and others";
    }
    const int64_t first = *id;
    int64_t last = first;
    for (++id; id != ids.end() && *id == last + 1; ++id) {
      last = *id;
    }
    text += (text.empty() ? "" : ", ") + std::to_string(first) +
            (last > first ? "-" + std::to_string(last) : "");
  }
  return text;
}

}  // namespace adit
