// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/option_values.hpp"

#include <charconv>
#include <functional>
#include <string_view>

#include "adit/tools/support/printed.hpp"

namespace adit {
namespace {

/// Complains unless the text is a number that `fits`.
CLI::Validator number(const std::string& wanted, const std::function<bool(double)>& fits) {
  const auto check = [wanted, fits](std::string& text) {
    double value = 0.0;
    const std::from_chars_result end =
        std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = end.ec == std::errc() && end.ptr == text.data() + text.size();
    return whole && fits(value) ? std::string()
                                : "'" + text + "' is not possible; it takes a number " + wanted;
  };
  return {check, ""};
}

}  // namespace

std::string listed_words(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  }
  return text;
}

CLI::Validator number_from(double low) {
  return number(printed("of %g or more", low), [low](double value) { return value >= low; });
}

CLI::Validator number_from(double low, double high) {
  return number(printed("from %.10g to %.10g", low, high),
                [low, high](double value) { return value >= low && value <= high; });
}

CLI::Validator number_above(double low) {
  return number(printed("above %g", low), [low](double value) { return value > low; });
}

std::string plain_complaint(const CLI::ParseError& error) {
  const std::string text = error.what();
  constexpr std::string_view kConversion = "Could not convert: ";
  const std::size_t equals = text.find(" = ");
  if (text.starts_with(kConversion) && equals != text.npos) {
    return text.substr(kConversion.size(), equals - kConversion.size()) + ": '" +
           text.substr(equals + 3) + "' is not a number that it takes";
  }
  return text;
}

}  // namespace adit
