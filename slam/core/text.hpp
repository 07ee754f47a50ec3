// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Numbers as texts, the same in every locale. Sentences with numbers in them are put together by
// fmt::format.
#pragma once

#include <concepts>
#include <string>

namespace adit {

/// For people: rounded to so many digits ("0.0123", "1.2e+06"), or with so many decimals ("12.0").
std::string in_digits(double value, int digits = 3);
std::string with_decimals(double value, int decimals);

/// For files and settings: the shortest text that reads back as the same number ("0.1", "1e+05").
std::string shortest(double value);
std::string shortest(float value);
template <std::integral Number>
std::string shortest(Number value) {
  return std::to_string(value);
}

}  // namespace adit
