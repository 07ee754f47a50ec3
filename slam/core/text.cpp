// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/text.hpp"

#include <array>
#include <charconv>

namespace adit {
namespace {

std::string text_of(double value, std::chars_format format, int precision) {
  std::array<char, 400> buffer{};  // the greatest double has 309 digits before its point
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, precision).ptr;
  return {buffer.data(), end};
}

}  // namespace

std::string in_digits(double value, int digits) {
  return text_of(value, std::chars_format::general, digits);
}

std::string with_decimals(double value, int decimals) {
  return text_of(value, std::chars_format::fixed, decimals);
}

}  // namespace adit
