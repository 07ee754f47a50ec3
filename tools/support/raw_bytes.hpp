// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>

namespace adit {

static_assert(std::endian::native == std::endian::little, "formats are written as memory has them");

/// A number as it lies in memory, little-endian.
template <class T>
void append_raw(std::string& bytes, T value) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

/// The number that lies `at` bytes behind `from`.
template <class T>
T load_raw(const char* from, std::size_t at) {
  T value;
  std::memcpy(&value, from + at, sizeof(T));
  return value;
}

template <class T>
void store_raw(char* to, std::size_t at, T value) {
  std::memcpy(to + at, &value, sizeof(T));
}

}  // namespace adit
