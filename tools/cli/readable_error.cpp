// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/readable_error.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace adit {
namespace {

/// "--output" from "-out".
bool is_long_name_with_one_dash(std::string_view word, std::string_view name) {
  return word.size() > 2 && word[0] == '-' && word[1] != '-' && name.starts_with("--") &&
         name.substr(2).starts_with(word.substr(1));
}

std::string mistaken_word(const CommandDescription& command, std::string_view word) {
  const std::size_t equals = word.find('=');
  for (const OptionDescription& option : command.options) {
    for (const std::string& name : option.names) {
      if (option.value.empty() && equals != word.npos && word.substr(0, equals) == name) {
        return name + " takes no value; leave out '" + std::string(word.substr(equals)) + "'";
      }
      if (is_long_name_with_one_dash(word, name)) {
        return "there is no option '" + std::string(word) + "'; write " +
               listed_words(option.names);
      }
    }
  }
  return {};
}

}  // namespace

std::string listed_words(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  }
  return text;
}

std::string number_complaint(const std::string& word, const std::string& wanted,
                             const std::function<bool(double)>& fits) {
  double value = 0.0;
  const std::from_chars_result end = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = end.ec == std::errc() && end.ptr == word.data() + word.size();
  return whole && fits(value) ? std::string()
                              : "'" + word + "' is not possible; it takes a number " + wanted;
}

std::string wanted_values(int least, int most, const std::string& names) {
  if (least < 2) {
    return {};
  }
  return ". It takes " + std::to_string(least) +
         (most > least ? " to " + std::to_string(most) : std::string()) + " numbers (" + names +
         "); write other words before it, or `--` between";
}

std::string readable_error(const std::string& text) {
  constexpr std::string_view kConversion = "Could not convert: ";
  const std::size_t equals = text.find(" = ");
  if (text.starts_with(kConversion) && equals != text.npos) {
    return text.substr(kConversion.size(), equals - kConversion.size()) + ": '" +
           text.substr(equals + 3) + "' is not a number that it takes";
  }
  // "--device: 1 required DEVICE missing"
  constexpr std::string_view kLacks = " required ";
  constexpr std::string_view kMissing = " missing";
  const std::size_t colon = text.find(": ");
  const std::size_t lacks = text.find(kLacks);
  if (colon != text.npos && lacks != text.npos && text.ends_with(kMissing)) {
    const std::size_t name = lacks + kLacks.size();
    return text.substr(0, colon) + " lacks its " +
           text.substr(name, text.size() - kMissing.size() - name);
  }
  return text;
}

std::string place_of_option(const std::string& command) {
  return "stands before " + command + ", which does not take it from there; write it behind";
}

std::string mistaken_words(const CommandDescription& program, std::span<const char* const> words) {
  const CommandDescription* command = &program;
  for (const std::string_view word : words) {
    if (word == "--") {
      break;
    }
    const auto below = std::ranges::find(command->commands, word, &CommandDescription::own_name);
    if (below != command->commands.end()) {
      command = &*below;
    } else if (std::string mistaken = mistaken_word(*command, word); !mistaken.empty()) {
      return mistaken;
    }
  }
  return {};
}

}  // namespace adit
