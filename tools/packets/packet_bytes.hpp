// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstring>
#include <span>

namespace adit {

/// All these sensors turn at 5 Hz at least.
inline constexpr std::chrono::seconds kLongestTurn(1);

/// A little-endian number; `from` must reach `at + sizeof(T)`.
template <class T>
T load(std::span<const std::byte> from, std::size_t at) {
  T value;
  std::memcpy(&value, from.subspan(at, sizeof(T)).data(), sizeof(T));
  return value;
}

}  // namespace adit
