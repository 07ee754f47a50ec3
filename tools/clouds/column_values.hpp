// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The numbers of a column, one after the other.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {

/// A number as it lies in a file.
template <class T>
T load_number(const std::byte* from, bool swap_bytes) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (swap_bytes) {
    std::reverse(bytes.begin(), bytes.end());
  }
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

/// Calls take(i, value) for each number of the column, in the column's own type.
template <class Take>
void for_each_value(const Column& column, std::size_t count, Take&& take) {
  const auto run = [&]<class T>(T) {
    for (std::size_t i = 0; i < count; ++i) {
      take(i, load_number<T>(column.data + column.offset + i * column.stride, column.swap_bytes));
    }
  };
  switch (column.type) {
    case ScalarType::i8:
      return run(int8_t{});
    case ScalarType::u8:
      return run(uint8_t{});
    case ScalarType::i16:
      return run(int16_t{});
    case ScalarType::u16:
      return run(uint16_t{});
    case ScalarType::i32:
      return run(int32_t{});
    case ScalarType::u32:
      return run(uint32_t{});
    case ScalarType::i64:
      return run(int64_t{});
    case ScalarType::u64:
      return run(uint64_t{});
    case ScalarType::f32:
      return run(float{});
    case ScalarType::f64:
      return run(double{});
  }
}

}  // namespace adit
