// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/text.hpp"

#include <array>
#include <charconv>

#include <fmt/core.h>

namespace adit {
namespace {

// fmt's own shortest texts have fewer exponents and so more letters: 100000 where this is 1e+05.
template <class Number>
std::string shortest_of(Number value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

}  // namespace

std::string in_digits(double value, int digits) {
  return fmt::format("{:.{}g}", value, digits);
}

std::string with_decimals(double value, int decimals) {
  return fmt::format("{:.{}f}", value, decimals);
}

std::string shortest(double value) {
  return shortest_of(value);
}

std::string shortest(float value) {
  return shortest_of(value);
}

}  // namespace adit
